#pragma once

#include <algorithm>
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

  /// Calls visit(tile, first cell of the tile, its index in a plane, count) for all cells that
  /// there are, in runs along rows.
  template <typename Visit>
  static void for_runs(const ReposeTiles& tiles, int32_t blocks_a_side, int32_t block,
                       const Visit& visit) {
    for (int32_t dy = 0; dy <= 1; ++dy) {
      for (int32_t dx = -1; dx <= 1; ++dx) {
        const int32_t column = block % blocks_a_side + dx;
        const int32_t row = block / blocks_a_side + dy;
        if (column < 0 || column >= blocks_a_side || row >= blocks_a_side) continue;
        ReposeTile* const tile = tiles[static_cast<size_t>(row * blocks_a_side + column)].get();
        if (tile != nullptr) for_part(*tile, dx, dy, visit);
      }
    }
  }
  /// The same cell by cell: visit(tile, cell, index in a plane).
  template <typename Visit>
  static void for_cells(const ReposeTiles& tiles, int32_t blocks_a_side, int32_t block,
                        const Visit& visit) {
    for_runs(tiles, blocks_a_side, block,
             [&](ReposeTile& tile, size_t cell, size_t at, size_t count) {
               for (size_t i = 0; i < count; ++i) visit(tile, cell + i, at + i);
             });
  }
  /// Copies such a run from a tile's plane to one of the window.
  static void copy_run(const ReposeTile::Plane& from, size_t cell, size_t count, Plane& to,
                       size_t at) {
    if (count == 1) {
      to[at] = from[cell];
    } else {
      std::copy_n(from.data() + cell, kReposeBlock, to.data() + at);
    }
  }

 private:
  template <typename Visit>
  static void for_part(ReposeTile& tile, int32_t dx, int32_t dy, const Visit& visit) {
    const int32_t last = kReposeBlock - 1;
    const int32_t begin = dx < 0 ? last : 0;
    const int32_t rows = dy > 0 ? 1 : kReposeBlock;
    for (int32_t y = 0; y < rows; ++y) {
      visit(tile, static_cast<size_t>(y * kReposeBlock + begin),
            at(begin + dx * kReposeBlock, y + dy * kReposeBlock),
            static_cast<size_t>(dx == 0 ? kReposeBlock : 1));
    }
  }
};

}  // namespace snowbough::snow
