// GLSL only: a texel's share of its pixel's snow. A share is proportional to projected area, so that
// surfaces of different slope in one pixel each get what falls on them.
#include "fall_frame.h"

uniform usampler2D weight_sum;
uniform ivec2 tile_origin;
uniform ivec2 tile_size;

/// Thickness in metres that the pixel of `target` gives a texel of `area` m2.
float share_of(uvec2 target, float area) {
  const int index = int(target.x) - 1;
  const ivec2 pixel = ivec2(index % tile_size.x, index / tile_size.x);
  const uint sum = max(texelFetch(weight_sum, pixel, 0).x, kPixelWeight / 2u);
  const float volume = snow_of_pixel(pixel + tile_origin) * fall.direction.w * fall.direction.w;
  return volume * (float(target.y) / float(sum)) / area;
}
