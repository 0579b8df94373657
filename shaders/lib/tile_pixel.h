#pragma once

// The pixels of a tile with its margin, stored row by row.
#include "kernel.h"
#include "snow_shared.h"

KERNEL_UNIFORM(ivec2, tile_size);

int pixel_index(ivec2 pixel) { return pixel.y * tile_size.x + pixel.x; }

/// Whether a pixel is the tile's own, not in its margin.
bool is_in_tile(ivec2 pixel) {
  return all(greaterThanEqual(pixel, ivec2(kTileMargin))) &&
         all(lessThan(pixel, tile_size - ivec2(kTileMargin)));
}
