#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "tree/rims/fork_field.h"
#include "tree/tubes/limb_tubes.h"

namespace snowbough::tree {

/// A vertex of a hole's rim.
struct RimPoint {
  int32_t vertex = -1;
  /// Where the base has it on the parent.
  TubePlace base;
  /// Quarter turns around the child at which its side begins.
  double quarter = 0.0;
  /// Where both limbs meet: quarter turns further around the child, arc length along it, and the
  /// place on the parent that is nearest to it.
  double turned = 0.0;
  double length = 0.0;
  TubePlace target;
  glm::dvec3 position{0.0};
};

/// The rim of the hole that a child leaves its parent through, once around the child, each point
/// beside the one before it.
using Rim = std::vector<RimPoint>;

/// Moves a rim's points onto the line in which both limbs meet: along the child's own surface,
/// lifted off by as much as the fillet between them is high there, up to where it leaves that of
/// its parent, lifted likewise. The fillet's middle runs through them then, so that what lies
/// around the hole keeps to the parent's surface and what lies beyond it to the child's. The points
/// lie evenly along the line: where a child leans along its parent, equal turns around it would put
/// half of the line between two of them.
///
/// @param rim  base and quarter of its points are given.
/// @param farthest  arc length on the child that the rim stays below.
void meet_limbs(const Fork& fork, const LimbTubes& tubes, double farthest, Rim& rim);

}  // namespace snowbough::tree
