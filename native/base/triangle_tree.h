#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <vector>

namespace snowbough::base {

/// The point of a triangle that is nearest to another. The triangle may be a segment or a point.
///
/// Method: C. Ericson, "Real-Time Collision Detection", 2005, section 5.1.5 (the regions of corners
/// and edges, told by projections).
glm::dvec3 nearest_on_triangle(const glm::dvec3& p, const std::array<glm::dvec3, 3>& triangle);

/// Triangles in groups, each group with a bounding volume hierarchy of its own: the nearest
/// triangle of one group.
class TriangleTree {
 public:
  struct Nearest {
    /// Index into the triangles; -1 where the group has none.
    int32_t triangle = -1;
    glm::dvec3 point{0.0};
    double squared_distance = std::numeric_limits<double>::infinity();
  };

  /// @param group_begin group g owns triangles [group_begin[g], group_begin[g + 1]).
  TriangleTree(const std::vector<glm::vec3>& vertices,
               const std::vector<std::array<int32_t, 3>>& triangles,
               const std::vector<int32_t>& group_begin);

  /// Of equally near ones the triangle with the smallest index.
  Nearest nearest(int32_t group, const glm::dvec3& p) const;

  /// The distance from `from` along the unit vector `way` to the first triangle of the group that
  /// is farther than `least`, from either side; infinity where there is none.
  ///
  /// Method: T. Moeller, B. Trumbore, "Fast, Minimum Storage Ray-Triangle Intersection", 1997.
  double distance_along(int32_t group, const glm::dvec3& from, const glm::dvec3& way,
                        double least) const;

 private:
  struct Box {
    glm::vec3 low, high;
  };
  struct Node {
    Box box;
    /// Entries of order_; a leaf where `second` is -1, else the children are the next node and
    /// `second`.
    int32_t begin, end;
    int32_t second;
  };
  void build(int32_t begin, int32_t end);

  std::vector<std::array<glm::vec3, 3>> corners_;
  /// Triangles of a leaf stand together.
  std::vector<int32_t> order_;
  std::vector<Node> nodes_;
  /// Per group: its root, or -1.
  std::vector<int32_t> roots_;
};

}  // namespace snowbough::base
