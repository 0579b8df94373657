#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "snow/movement/repose/links.h"

namespace snowbough::snow {

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
};

/// The bit of a window's row in a set of rows.
constexpr uint64_t row_bit(int32_t row) {
  return uint64_t{1} << static_cast<uint32_t>(row);
}

}  // namespace snowbough::snow
