#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "snow/repose/tile.h"

namespace snowbough::snow {

/// A block of a map with the cells that its links lead to: a column on either side and a row behind
/// the last. What works on a block copies these cells to a window, and back.
struct TileWindow {
  static constexpr int32_t kRows = kReposeBlock + 1;
  static constexpr int32_t kStride = 48;
  static constexpr int32_t kFirst = 8;
  using Plane = std::array<float, kRows * kStride>;

  /// Index in a plane: the block's own cells have columns and rows from 0 to kReposeBlock - 1.
  static constexpr size_t at(int32_t column, int32_t row) {
    return static_cast<size_t>(row * kStride + kFirst + column);
  }
  /// From a cell to its forward neighbour `k`.
  static constexpr int32_t step(int32_t k) { return kForwardRow[k] * kStride + kForwardColumn[k]; }
  /// Whether other blocks look at that cell.
  static constexpr bool is_border(size_t at) {
    const auto row = static_cast<int32_t>(at) / kStride;
    const int32_t column = static_cast<int32_t>(at) % kStride - kFirst;
    return row == 0 || row >= kReposeBlock - 1 || column <= 0 || column >= kReposeBlock - 1;
  }

  /// Calls visit(tile, cell of the tile, index in a plane) for all cells that there are.
  template <typename Visit>
  static void for_cells(const ReposeTiles& tiles, int32_t blocks_a_side, int32_t block,
                        const Visit& visit) {
    for (int32_t dy = 0; dy <= 1; ++dy) {
      for (int32_t dx = -1; dx <= 1; ++dx) {
        for_part(tiles, blocks_a_side, block, dx, dy, visit);
      }
    }
  }

 private:
  template <typename Visit>
  static void for_part(const ReposeTiles& tiles, int32_t blocks, int32_t block, int32_t dx,
                       int32_t dy, const Visit& visit) {
    const int32_t column = block % blocks + dx;
    const int32_t row = block / blocks + dy;
    if (column < 0 || column >= blocks || row >= blocks) return;
    ReposeTile* const tile = tiles[static_cast<size_t>(row * blocks + column)].get();
    if (tile == nullptr) return;
    const int32_t last = kReposeBlock - 1;
    const int32_t begin_x = dx < 0 ? last : 0;
    const int32_t end_x = dx > 0 ? 0 : last;
    const int32_t end_y = dy > 0 ? 0 : last;
    for (int32_t y = 0; y <= end_y; ++y) {
      for (int32_t x = begin_x; x <= end_x; ++x) {
        visit(*tile, static_cast<size_t>(y * kReposeBlock + x),
              at(x + dx * kReposeBlock, y + dy * kReposeBlock));
      }
    }
  }
};

}  // namespace snowbough::snow
