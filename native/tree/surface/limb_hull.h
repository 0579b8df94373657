#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "tree/surface/strip_tree.h"
#include "tree/surface/surface.h"

namespace snowbough::tree {

/// The round hull of a limb's rings: a cone between consecutive rings, with the rings' corner
/// radii. Tests whether points are clear of it in about logarithmic time.
class LimbHull {
 public:
  /// A hull without rings: every point is clear of it.
  LimbHull() = default;
  explicit LimbHull(const std::vector<Ring>& rings);

  /// Whether `point` is more than `margin` metres outside every cone.
  bool clears(const glm::dvec3& point, double margin) const;

 private:
  bool cone_clears(size_t first, const glm::dvec3& point, double margin) const;

  StripTree centres_;
  std::vector<double> corners_;
  /// Per node of the tree: its largest corner radius.
  std::vector<double> thickest_;
};

}  // namespace snowbough::tree
