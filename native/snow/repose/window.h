#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "snow/repose/tile.h"

namespace snowbough::snow {

/// A tile and its neighbours: by row and column from -1 to 1, null where there is none.
struct TilesAround {
  std::array<std::array<ReposeTile*, 3>, 3> tiles{};

  TilesAround(const ReposeTiles& all, int32_t blocks_a_side, int32_t block) {
    for (int32_t dy = -1; dy <= 1; ++dy) {
      for (int32_t dx = -1; dx <= 1; ++dx) {
        const int32_t column = block % blocks_a_side + dx;
        const int32_t row = block / blocks_a_side + dy;
        if (column < 0 || column >= blocks_a_side || row < 0 || row >= blocks_a_side) continue;
        tiles[static_cast<size_t>(dy + 1)][static_cast<size_t>(dx + 1)] =
            all[static_cast<size_t>(row * blocks_a_side + column)].get();
      }
    }
  }
  ReposeTile* at(int32_t dx, int32_t dy) const {
    return tiles[static_cast<size_t>(dy + 1)][static_cast<size_t>(dx + 1)];
  }
};

/// Marks the rows with links to a cell as active, in all tiles. `column` and `row` are relative to
/// the middle tile, from -1 to kReposeBlock.
void activate_cell(const TilesAround& around, int32_t column, int32_t row);

/// Records that the bound of a cell has been lowered, in all tiles whose window contains it: see
/// ReposeTile::rows_to_pass. Coordinates as in activate_cell.
void note_bound(const TilesAround& around, int32_t column, int32_t row);

/// A block of a map and the cells to which its links lead: one column on either side and one row
/// above. Functions that work on a block copy these cells to a window, and back.
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
  /// Whether other blocks read that cell.
  static constexpr bool is_border(int32_t column, int32_t row) {
    return row == 0 || row >= kReposeBlock - 1 || column <= 0 || column >= kReposeBlock - 1;
  }

  /// Whether a cell, counted from the block's first, is in its window.
  static constexpr bool has(int32_t column, int32_t row) {
    return column >= -1 && column <= kReposeBlock && row >= 0 && row <= kReposeBlock;
  }

  /// The tiles around the block that have a cell in their window, without the block's own: by row
  /// and column from -1 to 1, bit 3 * (row + 1) + column + 1.
  static constexpr uint32_t seen_by(int32_t column, int32_t row) {
    uint32_t bits = 0;
    for (int32_t dy = -1; dy <= 1; ++dy) {
      for (int32_t dx = -1; dx <= 1; ++dx) {
        const int32_t x = column - dx * kReposeBlock;
        const int32_t y = row - dy * kReposeBlock;
        if (has(x, y) && (dx != 0 || dy != 0)) bits |= 1u << static_cast<uint32_t>(3 * dy + dx + 4);
      }
    }
    return bits;
  }

  /// Calls visit(tile or null, first cell of the tile, column, count) for the runs of cells of a
  /// row, from column -1 to kReposeBlock.
  template <typename Visit>
  static void for_row(const TilesAround& around, int32_t row, const Visit& visit) {
    const int32_t dy = row / kReposeBlock;
    const int32_t first = row % kReposeBlock * kReposeBlock;
    visit(around.at(-1, dy), static_cast<size_t>(first + kReposeBlock - 1), -1, size_t{1});
    visit(around.at(0, dy), static_cast<size_t>(first), 0, static_cast<size_t>(kReposeBlock));
    visit(around.at(1, dy), static_cast<size_t>(first), kReposeBlock, size_t{1});
  }
  /// Copies a row from a plane of the tiles; `absent` for missing tiles.
  static void copy_row(const TilesAround& around, int32_t row, ReposeTile::Plane ReposeTile::*plane,
                       Plane& to, float absent) {
    for_row(around, row, [&](const ReposeTile* tile, size_t cell, int32_t column, size_t count) {
      float* const place = to.data() + at(column, row);
      if (tile == nullptr) {
        std::fill_n(place, count, absent);
      } else if (count == 1) {
        *place = (tile->*plane)[cell];
      } else {
        std::memcpy(place, (tile->*plane).data() + cell, kReposeBlock * sizeof(float));
      }
    });
  }
};

}  // namespace snowbough::snow
