#pragma once

// The pixels of a tile, which lie in buffers row by row. Buffer textures instead of plain ones,
// since llvmpipe reads them several times faster.
#include "kernel.h"

KERNEL_UNIFORM(ivec2, tile_size);

int pixel_index(ivec2 pixel) { return pixel.y * tile_size.x + pixel.x; }
