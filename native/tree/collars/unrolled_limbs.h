#pragma once

#include <cstdint>
#include <vector>

#include "tree/collars/collars.h"
#include "tree/tubes/fine_mesh.h"
#include "tree/tubes/limb_tubes.h"

namespace snowbough::tree {

/// The fine mesh on the limbs' unrolled surfaces: each vertex at its place on the limb of its
/// faces, vertices of collars on the parent.
struct UnrolledLimbs {
  /// Per vertex: its chain (-1 for vertices that only caps use), and its place.
  std::vector<int32_t> chain;
  std::vector<TubePlace> places;
  /// Per vertex: 1 if it never moves.
  std::vector<uint8_t> fixed;
  /// Per vertex of a collar: the fraction of the distance to its target that it has moved.
  std::vector<double> shares;
  /// Faces with all corners on one limb.
  std::vector<Quad> quads;
};

/// Moves every collar from its place on the base to its target, step by step, and the parent's
/// vertices around it as a membrane that is fixed at the collars and farther away. A collar stops
/// where faces would turn over.
///
/// @param collars, forks  one per junction, in the same order. Collars of forks that do not blend
/// stay.
/// @param unrolled  its places are changed.
void move_collars(const std::vector<Collar>& collars, const std::vector<Fork>& forks,
                  const LimbTubes& tubes, int threads, UnrolledLimbs& unrolled);

}  // namespace snowbough::tree
