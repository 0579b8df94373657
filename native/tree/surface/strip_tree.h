#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

namespace snowbough::tree {

/// A binary tree over runs of consecutive segments of a polyline, for searches that would look at
/// every segment otherwise. Each node bounds its run by the chord from the run's first point to its
/// last and the farthest that a point of the run strays from it.
///
/// Source: D. H. Ballard, "Strip trees: a hierarchical representation for curves", Communications
/// of the ACM 24, 1981.
class StripTree {
 public:
  /// Segments begin..end-1; segment i goes from point i to point i + 1.
  struct Node {
    int32_t begin = 0, end = 0;
    /// The second half's node; the first half's follows this one. 0 in a leaf.
    int32_t second = 0;
    double stray = 0.0;
  };

  /// Of fewer than two points it has no nodes.
  explicit StripTree(const std::vector<glm::dvec3>& points = {});

  /// The root first.
  const std::vector<Node>& nodes() const { return nodes_; }
  const std::vector<glm::dvec3>& points() const { return points_; }

  /// No point of the run is nearer than this to `point`, but for rounding(); may be negative.
  double least_distance(const Node& node, const glm::dvec3& point) const;

  /// Metres that rounding may take from the bound; far above what it does.
  double rounding() const { return rounding_; }

 private:
  int32_t add_node(int32_t begin, int32_t end);

  std::vector<glm::dvec3> points_;
  std::vector<Node> nodes_;
  double rounding_ = 0.0;
};

}  // namespace snowbough::tree
