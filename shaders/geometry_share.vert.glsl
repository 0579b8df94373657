#version 410 core
#extension GL_ARB_shading_language_420pack : require
// GEOMETRY's last part: a point a texel, with the texel's share of its pixel's snow.
#include "texel_target.h"
#include "texel_place.h"
#include "geometry_place.h"

uniform sampler2D weight_map;
uniform int resolution;

void main() {
  const TexelStep step = step_of(gl_VertexID, texel_object(gl_VertexID));
  thickness = 0.0;
  map_place = ivec3(-1);
  gl_Position = vec4(0.0, 0.0, 0.0, 1.0);
  if (step.weight == 0u) {
    return;
  }
  const ivec2 pixel = unpacked_pixel(step.pixel);
  const float sum = max(texelFetch(weight_map, pixel, 0).x, 0.5);
  const float volume = snow_of_pixel(pixel + tile_origin) * fall.direction.w * fall.direction.w;
  thickness = volume * (float(step.weight) / float(kPixelWeight) / sum) / step.area;
  map_place = decoded_place(texelFetch(texels, gl_VertexID).y, resolution, 1.0 / float(resolution));
}
