#pragma once

// The snow maps of trees as pages of one array texture, and the deepest snow of their tiles, see
// native/render/tree/snow_pages.h.
#include "shared_functions.h"
#include "shared_types.h"

#ifndef SNOWBOUGH_GLSL
namespace snowbough::shared {
#endif

/// Edge of a page, in texels.
const int kSnowPage = 512;
/// Edge of a tile of a page, in texels.
const int kSnowTile = 16;
/// Tiles along an edge of a page.
const int kPageTiles = kSnowPage / kSnowTile;

/// Pages along an edge of a map of this many texels.
SNOWBOUGH_SHARED_FUNCTION int pages_along(int texels) { return (texels + kSnowPage - 1) / kSnowPage; }

/// Layer of a page. `map`: width and height of the map in texels, and its first page.
SNOWBOUGH_SHARED_FUNCTION int snow_page(ivec2 page, ivec4 map) {
  return map.z + page.y * pages_along(map.x) + page.x;
}

/// Index of a tile of a map among the tiles of all pages.
SNOWBOUGH_SHARED_FUNCTION int snow_tile(ivec2 tile, ivec4 map) {
  const ivec2 page = tile / kPageTiles;
  const ivec2 own = tile - kPageTiles * page;
  return (snow_page(page, map) * kPageTiles + own.y) * kPageTiles + own.x;
}

#ifndef SNOWBOUGH_GLSL
}  // namespace snowbough::shared
#endif
