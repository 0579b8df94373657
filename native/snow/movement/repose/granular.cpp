#include "snow/movement/repose/granular.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "shaders/lib/texel_repose.h"
#include "snow/movement/repose/link_limits.h"

namespace snowbough::snow {
namespace {

/// Part of the rate of links along rows and columns with which diagonal ones carry, for flow that
/// is the same in all directions (the weights of the nine-point Laplacian, e.g. M. Patra and M.
/// Karttunen, Stencils with isotropic discretization error for differential operators, 2006).
constexpr float kDiagonal = 0.25f;

using Square = GranularSquares::Square;

/// The gradient on the square whose lower left corner is at a place of the window.
Square square_at(const GranularWindow& window, const TileWindow::Plane& top, size_t at) {
  const size_t right = at + 1;
  const size_t up = at + TileWindow::kStride;
  const size_t across = up + 1;
  Square square;
  if (window.is_square[at] == 0.0f ||
      window.holds[at] + window.holds[right] + window.holds[up] + window.holds[across] < 4.0f) {
    return square;
  }
  const auto along = [&](const TileWindow::Plane& plane) {
    return 0.5f * (plane[right] - plane[at] + plane[across] - plane[up]);
  };
  const auto upwards = [&](const TileWindow::Plane& plane) {
    return 0.5f * (plane[up] - plane[at] + plane[across] - plane[right]);
  };
  const glm::vec2 a(along(window.x), along(window.y));
  const glm::vec2 b(upwards(window.x), upwards(window.y));
  const float area = a.x * b.y - a.y * b.x;
  if (!(std::abs(area) > 1e-12f)) return square;
  const float rise_a = along(top);
  const float rise_b = upwards(top);
  square.is_there = true;
  square.gradient = {(rise_a * b.y - rise_b * a.y) / area, (rise_b * a.x - rise_a * b.x) / area};
  return square;
}

/// Squared horizontal length in metres of the step between two places.
float squared_way(const GranularWindow& window, size_t from, size_t to) {
  const float x = window.x[to] - window.x[from];
  const float y = window.y[to] - window.y[from];
  return x * x + y * y;
}

}  // namespace

void GranularSquares::find(const GranularWindow& window, const TileWindow::Plane& top,
                           int32_t row) {
  for (int32_t below = 0; below <= std::min(row, 1); ++below) {
    for (int32_t column = -1; column < kReposeBlock; ++column) {
      rows_[static_cast<size_t>(below)][static_cast<size_t>(column + 1)] =
          square_at(window, top, TileWindow::at(column, row - below));
    }
  }
}

void find_granular_row(const GranularWindow& window, const GranularSquares& squares,
                       const TileWindow::Plane& top, int32_t row, int32_t k, float slope,
                       const float* limit, GranularRow& granular) {
  // The squares beside a link: the first lies ahead of it, the second, of links along a row or a
  // column, on its other side.
  const size_t first = TileWindow::at(0, row);
  const size_t ahead = k == 3 ? first - 1 : first;
  const bool is_diagonal = k >= 2;
  const bool has_other = k == 1 || (k == 0 && row > 0);
  const size_t other = k == 1 ? first - 1 : first - TileWindow::kStride;
  for (size_t i = 0; i < static_cast<size_t>(kReposeBlock); ++i) {
    granular.limit[i] = limit[i];
    granular.rate[i] = 1.0f;
    if (!(limit[i] < kNoLink)) continue;
    const size_t from = first + i;
    const size_t to = from + static_cast<size_t>(TileWindow::step(k));
    const glm::vec2 way(window.x[to] - window.x[from], window.y[to] - window.y[from]);
    const float length = glm::length(way);
    if (!(limit[i] <= 1.001f * shared::kEven * slope * length)) continue;
    const auto column = static_cast<int32_t>(i);
    const Square& square = squares.at(k == 3 ? column - 1 : column, 0);
    const Square beside = !has_other ? Square()
                          : k == 1   ? squares.at(column - 1, 0)
                                     : squares.at(column, 1);
    if (!square.is_there && !beside.is_there) continue;
    const float squares = square.is_there && beside.is_there ? 2.0f : 1.0f;
    const glm::vec2 gradient = (square.gradient + beside.gradient) / squares;
    const float along = (top[from] - top[to]) / length;
    const float aside = (gradient.x * way.y - gradient.y * way.x) / length;
    const float steepest = std::sqrt(along * along + aside * aside);
    const float cosine = steepest > 0.0f ? std::abs(along) / steepest : 1.0f;
    granular.limit[i] = kGranularRest * slope * length * cosine;
    // The corner of a square beside the link, from which its sides lead.
    const size_t corner = square.is_there ? ahead + i : other + i;
    const float a = squared_way(window, corner, corner + 1);
    const float b = squared_way(window, corner, corner + TileWindow::kStride);
    // Short links carry fully, long ones as much as makes the flow the same in both directions.
    const float part = std::min(a, b) / std::max(a, b);
    const float of_long = 0.5f * part * (1.0f + part);
    granular.rate[i] = is_diagonal ? kDiagonal * part : (k == 0) == (a < b) ? 1.0f : of_long;
  }
}

}  // namespace snowbough::snow
