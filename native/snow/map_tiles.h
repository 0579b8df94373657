#pragma once

#include <algorithm>
#include <cstdint>

namespace snowbough::snow {

/// Tiles that a map is worked on by, so that what is bare can be passed over: long along u, where
/// texels lie one after the other in memory.
inline constexpr int32_t kTileWidth = 256;
inline constexpr int32_t kTileHeight = 4;

/// A map's tiles, numbered row by row; those at the upper and right border may be cut off.
struct MapTiles {
  explicit MapTiles(int32_t map_resolution)
      : resolution(map_resolution),
        columns((map_resolution + kTileWidth - 1) / kTileWidth),
        rows((map_resolution + kTileHeight - 1) / kTileHeight) {}

  int32_t resolution;
  int32_t columns;
  int32_t rows;

  int32_t count() const { return columns * rows; }
  /// Tile of a texel, by linear index.
  int32_t of(int32_t texel) const {
    return texel / resolution / kTileHeight * columns + texel % resolution / kTileWidth;
  }
  /// Calls `visit(first_texel, count)` for each of a tile's rows of texels.
  template <typename Visit>
  void for_each_row(int32_t tile, const Visit& visit) const {
    const int32_t column = tile % columns * kTileWidth;
    const int32_t width = std::min(kTileWidth, resolution - column);
    const int32_t first = tile / columns * kTileHeight;
    for (int32_t row = first; row < std::min(first + kTileHeight, resolution); ++row) {
      visit(row * resolution + column, width);
    }
  }
};

}  // namespace snowbough::snow
