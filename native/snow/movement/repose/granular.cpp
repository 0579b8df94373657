#include "snow/movement/repose/granular.h"

#include <algorithm>
#include <cmath>

#include "base/simd.h"
#include "shaders/lib/texel_repose.h"
#include "snow/movement/repose/link_limits.h"
#include "snow/movement/repose/tile_snow.h"

namespace snowbough::snow {
namespace {

/// Part of the rate of links along rows and columns with which diagonal ones carry, for flow that
/// is the same in all directions (the weights of the nine-point Laplacian, e.g. M. Patra and M.
/// Karttunen, Stencils with isotropic discretization error for differential operators, 2006).
constexpr float kDiagonal = 0.25f;

/// Links of a cell to those right of it, above it, and above right.
constexpr uint8_t kSquare = 7;

SNOWBOUGH_WIDE_FLAT void find_squares(const GranularWindow& window, const TileWindow::Plane& tops,
                                      int32_t row, GranularSquareRow& squares) {
  const auto first = TileWindow::at(-1, row);
  const float* __restrict const top = tops.data() + first;
  const float* __restrict const x = window.x.data() + first;
  const float* __restrict const y = window.y.data() + first;
  const float* __restrict const holds = window.holds.data() + first;
  const float* __restrict const is_square = window.is_square.data() + first;
  constexpr size_t kUp = TileWindow::kStride;
  const auto along = [](const float* plane, size_t i) {
    return 0.5f * (plane[i + 1] - plane[i] + plane[i + kUp + 1] - plane[i + kUp]);
  };
  const auto upwards = [](const float* plane, size_t i) {
    return 0.5f * (plane[i + kUp] - plane[i] + plane[i + kUp + 1] - plane[i + 1]);
  };
  // Squared horizontal length of a step.
  const auto squared = [&](size_t i, size_t to) {
    return (x[to] - x[i]) * (x[to] - x[i]) + (y[to] - y[i]) * (y[to] - y[i]);
  };
  for (size_t i = 0; i < squares.x.size(); ++i) {
    const float all = holds[i] + holds[i + 1] + holds[i + kUp] + holds[i + kUp + 1];
    const float a_x = along(x, i), a_y = along(y, i);
    const float b_x = upwards(x, i), b_y = upwards(y, i);
    const float area = a_x * b_y - a_y * b_x;
    const bool is_there = (is_square[i] != 0.0f) & (all >= 4.0f) & (std::abs(area) > 1e-12f);
    const float whole = is_there ? area : 1.0f;
    const float rise_a = along(top, i);
    const float rise_b = upwards(top, i);
    squares.is_there[i] = is_there ? 1.0f : 0.0f;
    squares.x[i] = is_there ? (rise_a * b_y - rise_b * a_y) / whole : 0.0f;
    squares.y[i] = is_there ? (rise_b * a_x - rise_a * b_x) / whole : 0.0f;
    squares.along[i] = squared(i, i + 1);
    squares.upwards[i] = squared(i, i + kUp);
  }
}

/// `square`: the squares ahead of the links; `beside`: those on the other side of links along a row
/// or a column; null: none. `first`: of the row's cells.
template <int32_t kLink>
inline void find_links(const GranularWindow& window, const float* __restrict top, size_t first,
                       const GranularSquareRow& square, const GranularSquareRow* beside,
                       size_t square_from, size_t beside_from, float slope,
                       const float* __restrict limit, GranularRow& granular) {
  const float* __restrict const x = window.x.data() + first;
  const float* __restrict const y = window.y.data() + first;
  constexpr auto kStep = static_cast<size_t>(TileWindow::step(kLink));
  for (size_t i = 0; i < static_cast<size_t>(kReposeBlock); ++i) {
    const size_t own = i + square_from;
    const size_t other = i + beside_from;
    const float way_x = x[i + kStep] - x[i];
    const float way_y = y[i + kStep] - y[i];
    const float length = std::sqrt(way_x * way_x + way_y * way_y);
    const bool is_there = square.is_there[own] != 0.0f;
    const bool is_beside = beside != nullptr && beside->is_there[other] != 0.0f;
    const bool flows = (limit[i] < kNoLink) &
                       (limit[i] <= 1.001f * shared::kEven * slope * length) &
                       (is_there | is_beside);
    const float squares = is_there & is_beside ? 2.0f : 1.0f;
    const float x_both = square.x[own] + (beside != nullptr ? beside->x[other] : 0.0f);
    const float y_both = square.y[own] + (beside != nullptr ? beside->y[other] : 0.0f);
    const float distance = flows ? length : 1.0f;
    const float along = (top[i] - top[i + kStep]) / distance;
    const float aside = (x_both / squares * way_y - y_both / squares * way_x) / distance;
    const float steepest = std::sqrt(along * along + aside * aside);
    const float cosine =
        steepest > 0.0f ? std::abs(along) / (steepest > 0.0f ? steepest : 1.0f) : 1.0f;
    // The sides of a square beside the link.
    const float a = is_there || beside == nullptr ? square.along[own] : beside->along[other];
    const float b = is_there || beside == nullptr ? square.upwards[own] : beside->upwards[other];
    // Short links carry fully, long ones as much as makes the flow the same in both directions.
    const float larger = std::max(a, b);
    const float part = std::min(a, b) / (larger > 0.0f ? larger : 1.0f);
    const float of_long = 0.5f * part * (1.0f + part);
    const float rate = kLink >= 2 ? kDiagonal * part : (kLink == 0) == (a < b) ? 1.0f : of_long;
    granular.limit[i] = flows ? kGranularRest * slope * length * cosine : limit[i];
    granular.rate[i] = flows ? rate : 1.0f;
  }
}

SNOWBOUGH_WIDE_FLAT void find_row(const GranularWindow& window, const GranularSquares& squares,
                                  const float* top, int32_t row, int32_t k, float slope,
                                  const float* limit, GranularRow& granular) {
  const size_t first = TileWindow::at(0, row);
  const GranularSquareRow& own = squares.row(0);
  // Squares are counted from column -1 on.
  if (k == 0) {
    find_links<0>(window, top + first, first, own, row > 0 ? &squares.row(1) : nullptr, 1, 1, slope,
                  limit, granular);
  } else if (k == 1) {
    find_links<1>(window, top + first, first, own, &own, 1, 0, slope, limit, granular);
  } else if (k == 2) {
    find_links<2>(window, top + first, first, own, nullptr, 1, 1, slope, limit, granular);
  } else {
    find_links<3>(window, top + first, first, own, nullptr, 0, 0, slope, limit, granular);
  }
}

}  // namespace

void GranularSquares::find(const GranularWindow& window, const TileWindow::Plane& top,
                           int32_t row) {
  if (last_ != row - 1 && row > 0) find_squares(window, top, row - 1, rows_[newest_]);
  newest_ = 1 - newest_;
  find_squares(window, top, row, rows_[newest_]);
  last_ = row;
}

SNOWBOUGH_WIDE void mark_grains(const float* __restrict area, const uint8_t* __restrict kind,
                                const uint8_t* __restrict forward, size_t count,
                                float* __restrict holds, float* __restrict is_square) {
  for (size_t i = 0; i < count; ++i) {
    const bool is_held = (area[i] > 0.0f) & ((kind[i] & (kWall | kFull)) == 0);
    holds[i] = is_held ? 1.0f : 0.0f;
    is_square[i] = is_held & ((forward[i] & kSquare) == kSquare) ? 1.0f : 0.0f;
  }
}

void find_granular_row(const GranularWindow& window, const GranularSquares& squares,
                       const TileWindow::Plane& top, int32_t row, int32_t k, float slope,
                       const float* limit, GranularRow& granular) {
  find_row(window, squares, top.data(), row, k, slope, limit, granular);
}

}  // namespace snowbough::snow
