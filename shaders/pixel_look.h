#pragma once

// What the second part of the deposit asks of a pixel of the tile.
#include "fall_frame.h"
#include "kernel.h"
#include "tile_pixel.h"
#include "triangle_object.h"

/// A SeenPixel each.
KERNEL_VIEW_RG32UI(occlusion);
KERNEL_VIEW_R32UI(weight_sum);
KERNEL_UNIFORM(ivec2, tile_origin);

bool gives_snow(ivec2 pixel) { return snow_of_pixel(pixel + tile_origin) > 0.0f; }

/// Whether its texels cover less than half of it.
bool is_bare(ivec2 pixel) { return texelFetch(weight_sum, pixel_index(pixel)).x < kPixelWeight / 2u; }
