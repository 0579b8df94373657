#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <vector>

namespace snowbough::base {

/// The point of a triangle nearest to `p`. The triangle may be a segment or a point.
///
/// Method: C. Ericson, "Real-Time Collision Detection", 2005, section 5.1.5 (Voronoi regions of
/// corners and edges, found by projections).
glm::dvec3 nearest_on_triangle(const glm::dvec3& p, const std::array<glm::dvec3, 3>& triangle);

/// Triangles in groups, with one bounding volume hierarchy per group, for queries of the nearest
/// triangle and of the first one on a ray.
class TriangleTree {
 public:
  struct Nearest {
    /// Index into the triangles; -1 if the group is empty.
    int32_t triangle = -1;
    glm::dvec3 point{0.0};
    double squared_distance = std::numeric_limits<double>::infinity();
  };

  /// @param group_begin group g owns triangles [group_begin[g], group_begin[g + 1]).
  TriangleTree(const std::vector<glm::vec3>& vertices,
               const std::vector<std::array<int32_t, 3>>& triangles,
               const std::vector<int32_t>& group_begin);

  /// The nearest triangle; of equally near ones, the one with the smallest index.
  /// @param hint a triangle of the group that is probably near, or -1; does not change the result.
  Nearest nearest(int32_t group, const glm::dvec3& p, int32_t hint = -1) const;

  /// Moves the vertices; the triangles stay. The tree may become slower, results stay the same.
  /// O(triangles).
  void refit(const std::vector<glm::vec3>& vertices,
             const std::vector<std::array<int32_t, 3>>& triangles);

  struct Hit {
    /// Index into the triangles; -1: none.
    int32_t triangle = -1;
    double distance = std::numeric_limits<double>::infinity();
  };

  /// The group's first triangle, from either side, on the ray from `from` along the unit vector
  /// `direction` at a distance over `least` and under `most`; of equally near ones, the one with
  /// the smallest index. No ray passes between triangles that share an edge.
  /// Method: S. Woop, C. Benthin, I. Wald, "Watertight Ray/Triangle Intersection", 2013.
  Hit first_along(int32_t group, const glm::dvec3& from, const glm::dvec3& direction, double least,
                  double most = std::numeric_limits<double>::infinity()) const;

 private:
  struct Box {
    glm::vec3 low, high;
  };
  struct Node {
    Box box;
    /// Entries of order_; `second` is -1 in a leaf; otherwise the children are the next node and
    /// `second`.
    int32_t begin, end;
    int32_t second;
  };
  void set_corners(const std::vector<glm::vec3>& vertices,
                   const std::vector<std::array<int32_t, 3>>& triangles);
  Box box_of(int32_t begin, int32_t end) const;
  void build(int32_t begin, int32_t end);

  std::vector<std::array<glm::vec3, 3>> corners_;
  /// Triangle indices; a leaf's triangles are consecutive.
  std::vector<int32_t> order_;
  std::vector<Node> nodes_;
  /// Root node of each group, or -1.
  std::vector<int32_t> roots_;
};

}  // namespace snowbough::base
