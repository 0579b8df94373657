#version 410 core
#extension GL_ARB_shading_language_420pack : require
// Algorithm 1 of the thesis: one point per pixel of the occlusion map, with the pixel's snow for the texel
// under its centre.
#include "glsl/texel_place.glsl"
#include "glsl/texel_under.glsl"
#include "glsl/triangle_object.glsl"

/// By texel of the group's batch: its place on the map, and a TexelStep.
uniform usamplerBuffer places;
uniform usamplerBuffer texel_steps;
/// Texels of the group in this batch: [first, end).
uniform uvec2 batch_texels;

/// In metres, negative on backs.
flat out float thickness;
/// Place on the layered map; z = -1 if there is no deposit.
flat out ivec3 map_place;

void main() {
  const ivec2 pixel = ivec2(gl_VertexID % tile_size.x, gl_VertexID / tile_size.x);
  thickness = 0.0;
  map_place = ivec3(-1);
  gl_Position = vec4(0.0, 0.0, 0.0, 1.0);
  const uint seen = texelFetch(occlusion, gl_VertexID).x;
  const uint object = seen == 0u ? 0u : object_of((seen & ~kBackFace) - 1u);
  const uint slot = object & kSlotBits;
  const bool is_back = (seen & kBackFace) != 0u;
  if (seen == 0u || (is_back && (object & kTwoSided) == 0u) || (object & kReceives) == 0u || slot < group_objects.x ||
      slot >= group_objects.y || !is_in_tile(pixel) || !gives_snow(pixel + tile_origin)) {
    return;
  }
  const uint owner = texel_under(pixel, (seen & ~kBackFace) - 1u, slot);
  if (owner == 0u || owner - 1u < batch_texels.x || owner - 1u >= batch_texels.y) {
    return;
  }
  const int texel = int(owner - 1u - batch_texels.x);
  const int resolution = textureSize(owners, 0).x;
  const float area = uintBitsToFloat(texelFetch(texel_steps, texel).y);
  thickness = snow_thickness() * pixel_size(projection) * pixel_size(projection) / area * (is_back ? -1.0 : 1.0);
  map_place = decoded_place(texelFetch(places, texel).x, resolution, 1.0 / float(resolution));
}
