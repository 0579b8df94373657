#version 410 core
#extension GL_ARB_shading_language_420pack : require
// GEOMETRY's second part, Algorithm 1 of the thesis: a point a pixel of the occlusion map, with the
// snow that the pixel's texels do not take, for the texel under the pixel's centre.
#include "texel_under.h"
#include "triangle_object.h"

uniform sampler2D weight_map;
/// Texels of the group in this batch: [first, end).
uniform uvec2 batch_texels;

flat out float volume;
/// Index in the batch of the texel under the centre; -1 where there is nothing to deposit.
flat out int texel;

void main() {
  const ivec2 pixel = ivec2(gl_VertexID % tile_size.x, gl_VertexID / tile_size.x);
  volume = 0.0;
  texel = -1;
  gl_Position = vec4(0.0, 0.0, 0.0, 1.0);
  const uint seen = texelFetch(occlusion, gl_VertexID).x;
  const uint object = seen == 0u ? 0u : object_of((seen & ~kBackFace) - 1u);
  const uint slot = object & ~kReceives;
  const float sum = texelFetch(weight_map, pixel, 0).x;
  if (seen == 0u || (seen & kBackFace) != 0u || (object & kReceives) == 0u ||
      slot < group_objects.x || slot >= group_objects.y || sum >= 0.5) {
    return;
  }
  const uint owner = texel_under(pixel, seen - 1u, slot);
  if (owner == 0u || owner - 1u < batch_texels.x || owner - 1u >= batch_texels.y) {
    return;
  }
  texel = int(owner - 1u - batch_texels.x);
  volume = (1.0 - sum / 0.5) * snow_of_pixel(pixel + tile_origin) * fall.direction.w *
           fall.direction.w;
}
