#pragma once

// How the deepest snow of a map is found, see native/render/draw/map_depths.h.
#include "shared_types.h"
#ifndef SNOWBOUGH_GLSL
namespace snowbough::shared {
#endif

/// Edge of a tile of a map, in texels: for each the deepest snow is known.
const int kSnowTile = 16;

#ifndef SNOWBOUGH_GLSL
}  // namespace snowbough::shared
#endif
