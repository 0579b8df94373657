#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "snow/movement/repose/tile.h"
#include "snow/movement/repose/window.h"

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
  /// Calls visit(tile or null, first cell of the tile, column, count) for the runs of cells of a
  /// row, from column -1 to kReposeBlock.
  template <typename Visit>
  void for_row(int32_t row, const Visit& visit) const {
    const int32_t dy = row / kReposeBlock;
    const int32_t first = row % kReposeBlock * kReposeBlock;
    visit(at(-1, dy), static_cast<size_t>(first + kReposeBlock - 1), -1, size_t{1});
    visit(at(0, dy), static_cast<size_t>(first), 0, static_cast<size_t>(kReposeBlock));
    visit(at(1, dy), static_cast<size_t>(first), kReposeBlock, size_t{1});
  }
  /// Copies a row from a plane of a part of the tiles; `absent` for missing tiles.
  template <typename Part, typename Plane>
  void copy_row(int32_t row, Part ReposeTile::*part, TilePlane Part::*plane, Plane& to,
                float absent) const {
    for_row(row, [&](const ReposeTile* tile, size_t cell, int32_t column, size_t count) {
      float* const place = to.data() + TileWindow::at(column, row);
      if (tile == nullptr) {
        std::fill_n(place, count, absent);
      } else if (count == 1) {
        *place = (tile->*part.*plane)[cell];
      } else {
        std::memcpy(place, (tile->*part.*plane).data() + cell, kReposeBlock * sizeof(float));
      }
    });
  }
};

/// Marks the blocks around one whose bit is set in `around`: see TileWindow::seen_by.
void mark_around(int32_t blocks_a_side, int32_t block, uint32_t around,
                 std::vector<uint8_t>& marks);

/// Marks the rows with links to a cell as active, in all tiles. `column` and `row` are relative to
/// the middle tile, from -1 to kReposeBlock.
void activate_cell(const TilesAround& around, int32_t column, int32_t row);

/// Records that the bound of a cell has been lowered, in all tiles whose window contains it: see
/// ReposeTile::rows_to_pass. Coordinates as in activate_cell.
void note_bound(const TilesAround& around, int32_t column, int32_t row);

}  // namespace snowbough::snow
