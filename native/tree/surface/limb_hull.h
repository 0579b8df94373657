#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "tree/surface/strip_tree.h"
#include "tree/surface/surface.h"

namespace snowbough::tree {

/// The round hull of a limb's rings: a cone between each ring and the next, as thick as the rings'
/// corner radii. Tells whether points stand clear of it in about logarithmic time, however many
/// rings there are.
class LimbHull {
 public:
  /// A hull without rings, of which every point stands clear.
  LimbHull() = default;
  explicit LimbHull(const std::vector<Ring>& rings);

  /// Whether `point` lies more than `margin` metres outside of every cone.
  bool clears(const glm::dvec3& point, double margin) const;

 private:
  bool cone_clears(size_t first, const glm::dvec3& point, double margin) const;

  StripTree centres_;
  std::vector<double> corners_;
  /// Per node of the tree: the largest of its corners.
  std::vector<double> thickest_;
};

}  // namespace snowbough::tree
