#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "tree/collars/fork_field.h"
#include "tree/tubes/limb_tubes.h"

namespace snowbough::tree {

/// A vertex of a hole's collar.
struct CollarPoint {
  int32_t vertex = -1;
  /// Its place on the parent in the base mesh.
  TubePlace base;
  /// Start of its side around the child, in quarter turns.
  double quarter = 0.0;
  /// Where both limbs meet: further quarter turns around the child, arc length along it, and the
  /// nearest place on the parent.
  double turned = 0.0;
  double length = 0.0;
  TubePlace target;
  glm::dvec3 position{0.0};
};

/// The collar of the hole through which a child leaves its parent, once around the child, in order.
using Collar = std::vector<CollarPoint>;

/// Moves a collar's points onto the intersection of both limbs: along the child's surface, offset
/// by the local height of their fillet, up to where it leaves the parent's surface with the same
/// offset. The points then lie on the middle of the fillet, so that the mesh around the hole stays
/// on the parent's surface and the mesh beyond it on the child's. The points are evenly spaced
/// along the line: with equal turns, half of the line of a child that leans along its parent would
/// be between two of them.
///
/// @param collar  with base and quarter of its points.
/// @param farthest  maximum arc length of the collar on the child.
void meet_limbs(const Fork& fork, const LimbTubes& tubes, double farthest, Collar& collar);

}  // namespace snowbough::tree
