#pragma once

#include <cstdint>
#include <vector>

#include "tree/rims/rims.h"
#include "tree/tubes/fine_mesh.h"
#include "tree/tubes/limb_tubes.h"

namespace snowbough::tree {

/// The fine mesh on the limbs' unrolled surfaces: each vertex at its place on the limb of its
/// faces, vertices of rims on the parent.
struct UnrolledLimbs {
  /// Per vertex: its chain (-1 for vertices that only caps use), and its place.
  std::vector<int32_t> chain;
  std::vector<TubePlace> places;
  /// Per vertex: 1 if it never moves.
  std::vector<uint8_t> fixed;
  /// Per vertex of a rim: the fraction of the distance to its target that it has moved.
  std::vector<double> shares;
  /// Faces with all corners on one limb.
  std::vector<Quad> quads;
};

/// Moves every rim from its place on the base to its target, step by step, and the parent's
/// vertices around it as a membrane that is fixed at the rims and farther away. A rim stops where
/// faces would turn over.
///
/// @param rims, forks  one per junction, in the same order. Rims of forks that do not blend stay.
/// @param unrolled  its places are changed.
void move_rims(const std::vector<Rim>& rims, const std::vector<Fork>& forks, const LimbTubes& tubes,
               int threads, UnrolledLimbs& unrolled);

}  // namespace snowbough::tree
