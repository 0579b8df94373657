#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "tree/collars/cones.h"
#include "tree/surface/surface.h"
#include "tree/tubes/limb_tubes.h"

namespace snowbough::tree {

/// A place where a limb leaves another, and both their tubes around it. Limbs that continue one
/// another form one chain, identified by its first branch.
struct Fork {
  int32_t parent_chain = -1, child_chain = -1;
  glm::dvec3 centre{0.0};
  /// Radius of the child's base, and the distance from the centre within which the fork has
  /// influence: until the child is clear of its parent.
  double radius = 0.0;
  double reach = 0.0;
  /// Whether the child has enough sides for a fillet: with four, each as long as its first row, the
  /// whole row would widen.
  bool blends = false;
  /// Where the child is deepest inside its parent, before its base. Metres along it.
  double inside = 0.0;

  /// The parent on both sides of the fork; the child from its base on; and the child's stretch
  /// inside the parent, before its base.
  ConeRun parent, child;
  Cone base;

  FieldValue from_parent(const glm::dvec3& p) const { return parent.distance_from(p, 1e300); }
};

/// One fork per junction of the surface, in its order.
std::vector<Fork> collect_forks(const Surface& surface, const LimbTubes& tubes);

/// Width of a fork's fillet at a place: see blended_distance.
double fillet_width(const Fork& fork, const glm::dvec3& p);

/// The blended surface of all limbs at some forks: the smooth minimum of the distances from their
/// tubes, thicker limbs first. The fillet is as wide as the radius of the child's base, and
/// vanishes towards the fork's reach, and where the surfaces are parallel.
FieldValue blended_distance(const glm::dvec3& p, std::span<const int32_t> at,
                            const std::vector<Fork>& forks);

}  // namespace snowbough::tree
