#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "snow/scene/projection.h"

namespace snowbough::snow {

/// A coarse grid over the ground with the lowest and highest point of an object over each cell:
/// most boxes that it does not reach need no ray.
class Outline {
 public:
  void set(const std::vector<glm::vec3>& points,
           const std::vector<std::array<int32_t, 3>>& triangles, const Bounds& bounds);

  /// Whether any of the object may be in a box; false only if none is.
  bool may_reach(const Bounds& box) const;

 private:
  /// Cells a side.
  static constexpr int32_t kSide = 64;
  struct Range {
    double low = 1e300;
    double high = -1e300;
  };
  int32_t cell_of(double at, int axis) const;
  void add(const std::array<glm::dvec3, 3>& triangle);

  Bounds bounds_;
  /// Of a cell, and its inverse.
  glm::dvec2 size_{1.0}, per_metre_{1.0};
  std::vector<Range> cells_;
};

}  // namespace snowbough::snow
