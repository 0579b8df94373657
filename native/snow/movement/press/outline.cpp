#include "snow/movement/press/outline.h"

#include <algorithm>
#include <cmath>

namespace snowbough::snow {
namespace {

/// Rounding is far below this part of a cell, which the object counts as larger.
constexpr double kSlack = 1e-3;

/// Calls visit(point) for the corners of the part of a triangle between two values of y.
template <typename Visit>
void for_corners_between(const std::array<glm::dvec3, 3>& triangle, double low, double high,
                         const Visit& visit) {
  for (size_t k = 0; k < 3; ++k) {
    const glm::dvec3& a = triangle[k];
    const glm::dvec3& b = triangle[(k + 1) % 3];
    if (a.y >= low && a.y <= high) visit(a);
    for (const double y : {low, high}) {
      if ((a.y < y) == (b.y < y)) continue;
      visit(a + (y - a.y) / (b.y - a.y) * (b - a));
    }
  }
}

}  // namespace

int32_t Outline::cell_of(double at, int axis) const {
  const double cell = (at - bounds_.low[axis]) * per_metre_[axis];
  return static_cast<int32_t>(std::clamp(cell, 0.0, static_cast<double>(kSide - 1)));
}

void Outline::add(const std::array<glm::dvec3, 3>& triangle) {
  const glm::dvec2 slack = kSlack * size_;
  const auto [first, last] = std::minmax({triangle[0].y, triangle[1].y, triangle[2].y});
  const int32_t end = cell_of(last + slack.y, 1);
  for (int32_t row = cell_of(first - slack.y, 1); row <= end; ++row) {
    const double low = bounds_.low.y + row * size_.y - slack.y;
    Bounds part;
    for_corners_between(triangle, low, low + size_.y + 2.0 * slack.y,
                        [&](const glm::dvec3& corner) { part.include(corner); });
    if (part.empty()) continue;
    const int32_t right = cell_of(part.high.x + slack.x, 0);
    for (int32_t column = cell_of(part.low.x - slack.x, 0); column <= right; ++column) {
      Range& range = cells_[static_cast<size_t>(row * kSide + column)];
      range.low = std::min(range.low, part.low.z);
      range.high = std::max(range.high, part.high.z);
    }
  }
}

void Outline::set(const std::vector<glm::vec3>& points,
                  const std::vector<std::array<int32_t, 3>>& triangles, const Bounds& bounds) {
  bounds_ = bounds;
  for (int axis = 0; axis < 2; ++axis) {
    size_[axis] = std::max((bounds.high[axis] - bounds.low[axis]) / kSide, 1e-9);
    per_metre_[axis] = 1.0 / size_[axis];
  }
  cells_.assign(static_cast<size_t>(kSide * kSide), {});
  for (const std::array<int32_t, 3>& triangle : triangles) {
    std::array<glm::dvec3, 3> corners;
    for (size_t k = 0; k < 3; ++k) {
      corners[k] = glm::dvec3(points[static_cast<size_t>(triangle[k])]);
    }
    add(corners);
  }
}

bool Outline::may_reach(const Bounds& box) const {
  for (int axis = 0; axis < 2; ++axis) {
    if (box.high[axis] < bounds_.low[axis] || box.low[axis] > bounds_.high[axis]) return false;
  }
  const int32_t bottom = cell_of(box.low.y, 1);
  const int32_t top = cell_of(box.high.y, 1);
  const int32_t left = cell_of(box.low.x, 0);
  const int32_t right = cell_of(box.high.x, 0);
  for (int32_t row = bottom; row <= top; ++row) {
    for (int32_t column = left; column <= right; ++column) {
      const Range& range = cells_[static_cast<size_t>(row * kSide + column)];
      if (range.low <= box.high.z && range.high >= box.low.z) return true;
    }
  }
  return false;
}

}  // namespace snowbough::snow
