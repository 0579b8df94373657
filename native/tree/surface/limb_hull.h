#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "tree/surface/surface.h"

namespace snowbough::tree {

/// The round hull of a limb's rings: a cone between each ring and the next, as thick as the rings'
/// corner radii. Tells whether points stand clear of it in about logarithmic time, however many
/// rings there are.
///
/// Method: a binary tree over runs of consecutive rings; each node bounds its run by a capsule
/// around the chord from the run's first centre to its last. D. H. Ballard, "Strip trees: a
/// hierarchical representation for curves", Communications of the ACM 24, 1981.
class LimbHull {
 public:
  /// A hull without rings, of which every point stands clear.
  LimbHull() = default;
  explicit LimbHull(const std::vector<Ring>& rings);

  /// Whether `point` lies more than `margin` metres outside of every cone.
  bool clears(const glm::dvec3& point, double margin) const;

 private:
  /// Segments begin..end-1, each from a ring to the next.
  struct Node {
    int32_t begin = 0, end = 0;
    /// The second half's node; the first half's follows this one. 0 in a leaf.
    int32_t second = 0;
    /// No centre of the run is farther than this from the chord, the thickest corner included.
    double reach = 0.0;
  };

  int32_t add_node(int32_t begin, int32_t end);
  double distance_to_chord(int32_t begin, int32_t end, const glm::dvec3& point) const;
  double outside(const Node& node, const glm::dvec3& point) const;
  bool segment_clears(int32_t segment, const glm::dvec3& point, double margin) const;

  std::vector<glm::dvec3> centres_;
  std::vector<double> corners_;
  std::vector<Node> nodes_;
  /// What rounding may take from a node's bound.
  double slack_ = 0.0;
};

}  // namespace snowbough::tree
