#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "base/group_by_key.h"

namespace snowbough::snow {

/// Tile size of the passes over a map, so that bare tiles can be skipped: long along u, where
/// texels are consecutive in memory.
inline constexpr int32_t kTileWidth = 32;
inline constexpr int32_t kTileHeight = 4;

/// A map's tiles, numbered row by row; tiles at the upper and right border may be cut off.
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
  /// Linear index of a tile's lowest and leftmost texel.
  int32_t first_texel(int32_t tile) const {
    return tile / columns * kTileHeight * resolution + tile % columns * kTileWidth;
  }
  int32_t width(int32_t tile) const {
    return std::min(kTileWidth, resolution - tile % columns * kTileWidth);
  }
  int32_t height(int32_t tile) const {
    return std::min(kTileHeight, resolution - tile / columns * kTileHeight);
  }
  /// Calls `visit(first_texel, count)` for each of a tile's rows of texels.
  template <typename Visit>
  void for_each_row(int32_t tile, const Visit& visit) const {
    const int32_t count = width(tile);
    int32_t first = first_texel(tile);
    for (int32_t row = 0; row < height(tile); ++row, first += resolution) visit(first, count);
  }
};

/// The tiles from which each tile reads values, recorded tile by tile.
class TileReads {
 public:
  TileReads() = default;
  explicit TileReads(int32_t tile_count) : noted_for_(static_cast<size_t>(tile_count), -1) {}

  /// Starts the next tile; the following notes belong to it.
  void begin_tile() { begin_.push_back(begin_.back()); }
  void note(int32_t tile) {
    const auto reader = static_cast<int32_t>(begin_.size()) - 2;
    if (std::exchange(noted_for_[tile], reader) == reader) return;
    tiles_.push_back(tile);
    ++begin_.back();
  }

  /// Whether one of the tiles that `tile` reads is `filled`.
  bool reads_filled(int32_t tile, const std::vector<uint8_t>& filled) const {
    return std::any_of(tiles_.begin() + begin_[tile], tiles_.begin() + begin_[tile + 1],
                       [&](int32_t other) { return filled[other] != 0; });
  }

 private:
  /// Start of each tile's list.
  std::vector<int32_t> begin_{0};
  std::vector<int32_t> tiles_;
  /// Per tile: the last tile that noted it.
  std::vector<int32_t> noted_for_;
};

/// `items` sorted by their tile `tile_of(item)`, stable; fills the start of each tile.
template <typename Item, typename TileOf>
std::vector<Item> sorted_by_tile(const std::vector<Item>& items, int32_t tile_count,
                                 const TileOf& tile_of, std::vector<int32_t>& begin) {
  const auto for_items = [&](const auto& visit) {
    for (const Item& item : items) visit(tile_of(item), item);
  };
  std::vector<Item> sorted;
  base::group_by_key(static_cast<size_t>(tile_count), for_items, begin, sorted);
  return sorted;
}

}  // namespace snowbough::snow
