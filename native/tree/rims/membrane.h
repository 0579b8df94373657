#pragma once

#include <cmath>
#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "tree/mesh/neighbours.h"
#include "tree/rims/rims.h"
#include "tree/rims/unrolled_limbs.h"

namespace snowbough::tree {

/// Difference between two places on the same limb, the short way around.
glm::dvec2 difference(const TubePlace& from, const TubePlace& to);

/// Range around a hole in which vertices move, in metres on the unrolled parent.
struct RimReach {
  int32_t junction = -1;
  TubePlace centre;
  double radius = 0.0;
  double quarter_length = 1.0;
  /// Distance of the rim's point that moves farthest.
  double farthest = 0.0;
  /// Maximum lead in metres of a point over the rim's slowest: half of the hole, otherwise the hole
  /// would turn inside out.
  double most_ahead = 0.0;
  /// Length of the faces beside the rim that the fillet needs.
  double spread = 0.0;
  /// Vertices up to this many edges from the rim are spread out.
  int spread_depth = 0;

  double metres(const glm::dvec2& offset) const {
    const double x = offset.x * quarter_length;
    return std::sqrt(x * x + offset.y * offset.y);
  }
  double from_centre(const TubePlace& place) const { return metres(difference(centre, place)); }
};
/// Per vertex and per face: its index in its membrane, or -1. Shared by all membranes; membranes
/// processed at the same time have none in common.
struct Locals {
  std::vector<int32_t> nodes, faces;
};

/// Moves the rims of some junctions on one chain, and the vertices within their range, as far as
/// possible without turning a face over.
void move_membrane(const Neighbours& neighbours, const std::vector<Rim>& rims,
                   std::span<const RimReach> reaches, UnrolledLimbs& unrolled, Locals& locals);

}  // namespace snowbough::tree
