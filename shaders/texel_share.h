#pragma once

// A texel's share of its pixel's snow. A share is proportional to projected area, so that
// surfaces of different slope in one pixel each get what falls on them.
#include "fall_frame.h"
#include "kernel.h"
#include "packed_pixel.h"
#include "tile_pixel.h"

/// Per pixel of the tile: the sum of its texels' weights.
KERNEL_VIEW_R32UI(weight_sum);
KERNEL_UNIFORM(ivec2, tile_origin);

/// Thickness in metres that the pixel of `target` gives a texel of `area` m2. Texels that together cover
/// less than half of their pixel take no more than half a pixel would hold.
float share_of(uvec2 target, float area) {
  const ivec2 pixel = unpacked_pixel(target.x);
  const float sum = float(max(texelFetch(weight_sum, pixel_index(pixel)).x, kPixelWeight / 2u));
  const float volume = snow_of_pixel(pixel + tile_origin) * fall.direction.w * fall.direction.w;
  return volume * float(target.y) / (sum * area);
}
