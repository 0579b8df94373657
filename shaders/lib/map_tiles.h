#pragma once

// How the deepest snow of a map is found, see native/render/draw/map_depths.h.
#include "shared_types.h"
#ifndef SNOWBOUGH_GLSL
namespace snowbough::shared {
#endif

/// Edge of a tile of a map, in texels: for each the deepest snow is known.
const int kSnowTile = 16;
/// Invocations that look for the deepest of all tiles.
const int kDeepestGroup = 64;

#ifndef SNOWBOUGH_GLSL
}  // namespace snowbough::shared
#endif
