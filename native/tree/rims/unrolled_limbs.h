#pragma once

#include <cstdint>
#include <vector>

#include "tree/rims/rims.h"
#include "tree/tubes/fine_mesh.h"
#include "tree/tubes/limb_tubes.h"

namespace snowbough::tree {

/// The fine mesh laid out on the limbs' unrolled surfaces: each vertex at its place on the limb
/// that its faces belong to, those of rims on the parent's.
struct UnrolledLimbs {
  /// Per vertex: the chain that it lies on, -1 for those that only caps have; and where.
  std::vector<int32_t> chain;
  std::vector<TubePlace> places;
  /// Per vertex: 1 where it stays whatever moves around it.
  std::vector<uint8_t> fixed;
  /// Per vertex of a rim: the share of its way to its target that it has gone.
  std::vector<double> shares;
  /// Faces that lie on one limb with all their corners.
  std::vector<Quad> quads;
};

/// Moves every rim from where the base has it to its target, step by step, and what lies around it
/// on the parent along with it: as a membrane that is fixed at the rims and further away. Where
/// faces would turn over, a rim stays behind.
///
/// @param rims, forks  one a junction, in the same order. Rims of forks that do not blend stay.
/// @param unrolled  whose places move.
void move_rims(const std::vector<Rim>& rims, const std::vector<Fork>& forks, const LimbTubes& tubes,
               int threads, UnrolledLimbs& unrolled);

}  // namespace snowbough::tree
