#include "tree/rings/square_rows.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

namespace snowbough::tree {
namespace {

/// Maximum length of a link relative to its neighbour in the row, ...
constexpr double kJump = 6.0;
/// ... and relative to both. In three trees with their order kept, the longest was 2.05 times as
/// long.
constexpr double kJumpInside = 2.5;
/// A link is replaced by another one whose step, turn and taper match their neighbours better by
/// this factor.
constexpr double kBetterFit = 0.6;
constexpr double kTurnMisfit = 4.0;

/// Mismatch of three planes in a row: change of the step, turn, change of the taper.
double misfit_of(const Plane& a, const Plane& b, const Plane& c) {
  const glm::dvec3 in = b.centre - a.centre, out = c.centre - b.centre;
  const double before = glm::length(in), after = glm::length(out);
  if (before == 0.0 || after == 0.0) return 1e3;
  const double least = 1e-6 * (before + after);
  const auto taper = [&](const Plane& x, const Plane& y) {
    return std::log(std::max(y.radius, least) / std::max(x.radius, least));
  };
  return std::abs(std::log(after / before)) +
         kTurnMisfit * (1.0 - glm::dot(in, out) / (before * after)) +
         std::min(std::abs(taper(b, c) - taper(a, b)), 1.0);
}

}  // namespace

void Rows::link(const Link& link) {
  if (next_[link.from][link.from_side] >= 0 || next_[link.to][link.to_side] >= 0) return;
  if (too_long(link.from, link.from_side, link.length) ||
      too_long(link.to, link.to_side, link.length)) {
    return;
  }
  const auto from = static_cast<int32_t>(link.from), to = static_cast<int32_t>(link.to);
  if (row_.find(from) == row_.find(to)) return;
  row_.join(from, to);
  next_[link.from][link.from_side] = link.to;
  next_[link.to][link.to_side] = link.from;
  length_[link.from][link.from_side] = length_[link.to][link.to_side] = link.length;
}

bool Rows::relink(const Links& links, const std::vector<Plane>& planes) {
  bool any = false;
  for (size_t i = 0; i < next_.size(); ++i) {
    for (int side = 0; side < 2; ++side) {
      const int64_t linked = next_[i][side];
      if (linked < 0 || next_[i][1 - side] < 0) continue;
      const auto old = static_cast<size_t>(linked);
      double least = kBetterFit * misfit(planes, i, side, old, side_to(old, i));
      const Link* better = nullptr;
      for (const Link& link : links.of(i, side)) {
        if (next_[link.to][link.to_side] >= 0 || next_[link.to][1 - link.to_side] < 0) continue;
        const double fit = misfit(planes, i, side, link.to, link.to_side);
        if (fit < least && !in_row_of(i, side, link.to)) {
          least = fit;
          better = &link;
        }
      }
      if (better == nullptr) continue;
      next_[old][side_to(old, i)] = -1;
      next_[i][side] = better->to;
      next_[better->to][better->to_side] = static_cast<int64_t>(i);
      length_[i][side] = length_[better->to][better->to_side] = better->length;
      any = true;
    }
  }
  find_rows();
  return any;
}

void Rows::cut_jumps() {
  std::vector<std::pair<size_t, int>> jumps;
  for (size_t i = 0; i < next_.size(); ++i) {
    for (int side = 0; side < 2; ++side) {
      const int64_t other = next_[i][side];
      if (other < 0 || next_[i][1 - side] < 0) continue;
      const int there = side_to(static_cast<size_t>(other), i);
      if (next_[other][1 - there] < 0) continue;
      const double longest = std::max(length_[i][1 - side], length_[other][1 - there]);
      if (length_[i][side] > kJumpInside * longest) jumps.emplace_back(i, side);
    }
  }
  for (const auto& [plane, side] : jumps) next_[plane][side] = -1;
  find_rows();
}

std::vector<std::vector<size_t>> Rows::rows() const {
  std::vector<std::vector<size_t>> all;
  std::vector<char> seen(next_.size(), 0);
  for (size_t i = 0; i < next_.size(); ++i) {
    if (seen[i] != 0 || (next_[i][0] >= 0 && next_[i][1] >= 0)) continue;
    std::vector<size_t> row;
    for (int64_t at = static_cast<int64_t>(i); at >= 0;) {
      row.push_back(static_cast<size_t>(at));
      seen[at] = 1;
      const auto& [one, other] = next_[at];
      at = one >= 0 && seen[one] == 0 ? one : other >= 0 && seen[other] == 0 ? other : -1;
    }
    all.push_back(std::move(row));
  }
  return all;
}

int Rows::side_to(size_t plane, size_t other) const {
  return next_[plane][0] == static_cast<int64_t>(other) ? 0 : 1;
}

bool Rows::in_row_of(size_t i, int side, size_t plane) const {
  size_t from = i;
  int64_t at = next_[i][1 - side];
  while (at >= 0) {
    if (static_cast<size_t>(at) == plane) return true;
    const auto here = static_cast<size_t>(at);
    at = next_[here][1 - side_to(here, from)];
    from = here;
  }
  return false;
}

double Rows::misfit(const std::vector<Plane>& planes, size_t i, int side, size_t j,
                    int j_side) const {
  double sum = misfit_of(planes[next_[i][1 - side]], planes[i], planes[j]);
  if (next_[j][1 - j_side] < 0) return sum;
  sum += misfit_of(planes[i], planes[j], planes[next_[j][1 - j_side]]);
  return 0.5 * sum;
}

void Rows::find_rows() {
  row_ = base::UnionFind(next_.size());
  for (size_t i = 0; i < next_.size(); ++i) {
    for (const int64_t other : next_[i]) {
      if (other >= 0) row_.join(static_cast<int32_t>(i), static_cast<int32_t>(other));
    }
  }
}

bool Rows::too_long(size_t plane, int side, double length) const {
  return next_[plane][1 - side] >= 0 && length > kJump * length_[plane][1 - side];
}

}  // namespace snowbough::tree
