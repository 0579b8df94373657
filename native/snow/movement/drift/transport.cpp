#include "snow/movement/drift/transport.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/parallel_for.h"

namespace snowbough::snow {
namespace {

/// Distances in metres in which all but 1 / e of too much snow settles, and of missing snow is
/// picked up: where the wind digs, and on open ground.
constexpr double kSettles = 2.0;
constexpr double kFetch = 150.0;
/// Slope up to what stands upwind: below the first there is no shelter, above the second nothing is
/// carried.
constexpr double kOpenSlope = 0.03;
constexpr double kCalmSlope = 0.12;
/// How much more the wind carries for each unit of slope up to an obstacle that begins within
/// kAhead metres downwind, up to a slope of kSteepestAhead. Obstacles are higher than kLowObstacle
/// metres.
constexpr double kDigs = 0.35;
constexpr double kAhead = 1.5;
constexpr double kSteepestAhead = 2.0;
constexpr double kLowObstacle = 0.2;
/// Carried snow spreads sideways as by diffusion: the square of this many metres for each two
/// metres of way.
constexpr double kSideways = 0.02;
/// The most flux in m2 of a part of a step, and the most parts.
constexpr double kPassFlux = 0.02;
constexpr double kMaxPasses = 32.0;
/// The slope of the ground where it begins is taken over this distance in metres.
constexpr double kBeginReach = 1.0;

/// What the wind carries at a slope up to what stands upwind, relative to open ground.
double carried(double slope) {
  return std::clamp((kCalmSlope - slope) / (kCalmSlope - kOpenSlope), 0.0, 1.0);
}

/// What the wind can carry above a grid's cells, relative to open level ground.
class Capacity {
 public:
  explicit Capacity(DriftGrid& grid) : grid_(grid), relative_(grid.cells.size()) {
    base::for_each_item(static_cast<size_t>(grid.rows), 16,
                        [&](size_t row) { find(static_cast<int32_t>(row)); });
  }
  double at(int32_t column, int32_t row) const { return relative_[number(column, row)]; }
  /// What enters a row at its first cell with anything in it.
  double entering(int32_t column, int32_t row) const { return carried(beginning(column, row)); }

 private:
  size_t number(int32_t column, int32_t row) const {
    return static_cast<size_t>(column) * static_cast<size_t>(grid_.rows) + static_cast<size_t>(row);
  }

  /// Slope down the wind of the ground on which a row begins; 0 if it begins otherwise.
  double beginning(int32_t column, int32_t row) const {
    const auto reach = static_cast<int32_t>(std::ceil(kBeginReach / grid_.cell));
    const DriftCell& first = grid_.at(column, row);
    if (first.is_obstacle || column + reach >= grid_.columns) return 0.0;
    const DriftCell& other = grid_.at(column + reach, row);
    return other.ground > 0.0 ? (first.top - other.top) / (reach * grid_.cell) : 0.0;
  }

  /// The steepest slope up to an obstacle close downwind.
  double rise_ahead(int32_t column, int32_t row) const {
    const auto reach = static_cast<int32_t>(std::ceil(kAhead / grid_.cell));
    const double own = grid_.at(column, row).top;
    double steepest = 0.0;
    for (int32_t k = 1; k <= reach && column + k < grid_.columns; ++k) {
      const DriftCell& other = grid_.at(column + k, row);
      if (!other.is_obstacle || !(other.top - own > kLowObstacle)) continue;
      steepest = std::max(steepest, (other.top - own) / (k * grid_.cell));
    }
    return std::min(steepest, kSteepestAhead);
  }

  /// A row. The hull of what lies upwind, from above, has the point of the steepest slope next to
  /// each new point.
  void find(int32_t row) {
    thread_local std::vector<std::pair<double, double>> hull;
    hull.clear();
    const auto slope = [](const auto& a, const auto& b) {
      return (a.second - b.second) / (b.first - a.first);
    };
    for (int32_t column = 0; column < grid_.columns; ++column) {
      const DriftCell& cell = grid_.at(column, row);
      if (cell.is_empty()) continue;
      const std::pair<double, double> point(column * grid_.cell, cell.top);
      if (hull.empty()) {
        // The ground before the first cell goes on as it begins.
        hull.emplace_back(point.first - kBeginReach,
                          point.second + beginning(column, row) * kBeginReach);
      }
      while (hull.size() > 1 &&
             slope(hull[hull.size() - 2], hull.back()) >= slope(hull.back(), point)) {
        hull.pop_back();
      }
      if (cell.ground > 0.0) {
        relative_[number(column, row)] =
            carried(slope(hull.back(), point)) * (1.0 + kDigs * rise_ahead(column, row));
      }
      hull.push_back(point);
    }
  }

  DriftGrid& grid_;
  std::vector<double> relative_;
};

/// A part of a step.
double move_part(DriftGrid& grid, double flux) {
  const Capacity capacity(grid);
  const double settles = -std::expm1(-grid.cell / kSettles);
  const double picks_up = -std::expm1(-grid.cell / kFetch);
  const double aside = std::min(kSideways / grid.cell, 0.25);
  const auto rows = static_cast<size_t>(grid.rows);
  // Above each row, in m3 for each metre across the wind; and whether the row has begun.
  std::vector<double> carries(rows, 0.0), flows(rows, 0.0);
  std::vector<uint8_t> has_begun(rows, 0);
  // Rows without ground take no part.
  std::vector<uint8_t> has_ground(rows, 0);
  for (size_t i = 0; i < grid.cells.size(); ++i) has_ground[i % rows] |= grid.cells[i].ground > 0.0;
  double balance = 0.0;
  for (int32_t column = 0; column < grid.columns; ++column) {
    for (int32_t row = 0; row < grid.rows; ++row) {
      DriftCell& cell = grid.at(column, row);
      const auto i = static_cast<size_t>(row);
      if (has_begun[i] < has_ground[i] && !cell.is_empty()) {
        has_begun[i] = 1;
        carries[i] = flux * capacity.entering(column, row);
        balance -= carries[i];
      }
      if (!(cell.ground > 0.0)) continue;
      const double can = flux * capacity.at(column, row);
      double gain = 0.0;
      if (carries[i] > can) {
        gain = (carries[i] - can) * settles;
      } else {
        const double digs = std::max(can - std::max(carries[i], flux), 0.0) * settles;
        gain = -digs - std::max(std::min(can, flux) - carries[i], 0.0) * picks_up;
      }
      if (gain == 0.0) continue;
      gain *= cell.ground / (grid.cell * grid.cell);
      const double volume = std::max(gain * grid.cell, -cell.loose);
      carries[i] -= volume / grid.cell;
      cell.change += volume;
      cell.loose += volume;
      cell.top += volume / cell.ground;
    }
    for (size_t i = 0; i + 1 < rows; ++i) {
      const bool is_open = has_begun[i] != 0 && has_begun[i + 1] != 0;
      flows[i] = is_open ? aside * (carries[i + 1] - carries[i]) : 0.0;
    }
    for (size_t i = 0; i < rows; ++i) {
      carries[i] += flows[i] - (i > 0 ? flows[i - 1] : 0.0);
    }
  }
  for (const double leaves : carries) balance += leaves;
  return balance * grid.cell;
}

}  // namespace

double transport(DriftGrid& grid, double flux) {
  for (DriftCell& cell : grid.cells) cell.change = 0.0;
  const double parts = std::clamp(std::ceil(flux / kPassFlux), 1.0, kMaxPasses);
  double balance = 0.0;
  for (double part = 0.0; part < parts; part += 1.0) balance += move_part(grid, flux / parts);
  return balance;
}

}  // namespace snowbough::snow
