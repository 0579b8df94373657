#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "snow/movement/repose/window.h"

namespace snowbough::snow {

/// Heaps of grains, such as sand, are cones. Links in eight directions with limits of their own
/// would make them pyramids of eight sides: between two links a slope could be steeper than along
/// one. So grains flow where the whole gradient is too steep: the limit of a link is the slope at
/// rest times the cosine of the angle between the link and the steepest way down the heap. On
/// stretched layouts, longer links carry less, so that grains move straight down.
///
/// What this needs of the window of a block.
struct GranularWindow {
  /// Horizontal places of the cells in metres.
  TileWindow::Plane x, y;
  /// 1 for cells on which grains can lie; and for cells that are linked with three others of which
  /// they are the lower left one; else 0.
  TileWindow::Plane holds, is_square;
};

/// Tangent of the slope at rest times this is the limit of a link straight down: a flow ends below
/// the limit, at its rest.
inline constexpr float kGranularRest = 1.04f;
/// Fraction of the slope at rest below which grains rest whatever the direction of their links:
/// less than cos(22.5 degrees).
inline constexpr float kGranularSure = 0.9f;

/// For a row of cells in a round: the limits in metres of the links to their neighbours `k`, and
/// the part of the usual rate with which they carry.
struct GranularRow {
  std::array<float, kReposeBlock> limit, rate;
};

/// Squares between four cells, in a row from column -1 on; a square has the place of its lower left
/// cell. 1 if grains lie on all four, else 0; the gradient of their surface, 0 if not; and the
/// squared lengths in m2 of its lower and its left side, seen from above.
struct GranularSquareRow {
  std::array<float, kReposeBlock + 1> is_there, x, y, along, upwards;
};

/// The squares of a row and of the one before.
class GranularSquares {
 public:
  /// Computes the squares of rows row - 1 (from row 1 on) and row. The window's rows row - 1, row
  /// and row + 1 must be filled, and not change between calls.
  void find(const GranularWindow& window, const TileWindow::Plane& top, int32_t row);
  /// Of that row, or with `below` 1 of the one before.
  const GranularSquareRow& row(size_t below) const { return rows_[(newest_ + below) % 2]; }

 private:
  std::array<GranularSquareRow, 2> rows_;
  size_t newest_ = 0;
  int32_t last_ = -2;
};

/// Marks cells of a row in GranularWindow. `area`: m2; `kind`, `forward`: as in ReposeTile.
void mark_grains(const float* area, const uint8_t* kind, const uint8_t* forward, size_t count,
                 float* holds, float* is_square);

/// `squares`: of the row; `slope`: tangent of the angle of repose; `top`: heights of the surface;
/// `limit`: the links' usual limits, which stay where nothing flows or where snow stands.
void find_granular_row(const GranularWindow& window, const GranularSquares& squares,
                       const TileWindow::Plane& top, int32_t row, int32_t k, float slope,
                       const float* limit, GranularRow& granular);

}  // namespace snowbough::snow
