// Third part of the deposit: every texel that takes part gets its share of its pixel's snow. A share
// is proportional to projected area, so that surfaces of different slope in one pixel each get
// what falls on them.
#include "fall_frame.h"

layout(local_size_x = 64) in;
layout(std430) readonly buffer TexelSurface { vec4 texel_surface[]; };
layout(std430) readonly buffer TexelTargets { TexelTarget targets[]; };
/// Thickness in metres; 0 at the start of a step.
layout(std430) writeonly buffer DepositShare { float deposit_share[]; };
uniform usampler2D weight_sum;
uniform ivec2 tile_origin;
uniform ivec2 tile_size;

void main() {
  const uint index = gl_GlobalInvocationID.x;
  const TexelTarget target = targets[index];
  if (target.pixel == 0u) {
    return;
  }
  const int pixel_index = int(target.pixel - 1u);
  const ivec2 pixel = ivec2(pixel_index % tile_size.x, pixel_index / tile_size.x);
  const uint sum = max(texelFetch(weight_sum, pixel, 0).x, kPixelWeight / 2u);
  const float volume = snow_of_pixel(pixel + tile_origin) * fall.direction.w * fall.direction.w;
  deposit_share[index] = volume * (float(target.weight) / float(sum)) / texel_surface[index].w;
}
