#pragma once

#include <vector>

#include "base/parallel_for.h"
#include "tree/surface/limb_path.h"
#include "tree/surface/surface.h"

namespace snowbough::tree {

struct UncrossedSurface {
  Surface surface;
  /// Children whose junction still has intersecting faces.
  std::vector<int32_t> crossing;
  /// Branches whose base was narrowed to avoid others.
  std::vector<int32_t> narrowed;
};

/// Builds the surface repeatedly for the few junctions with intersecting faces: each round narrows
/// the bases of the branches that intersect there, moves their first ring out, and drops rings that
/// cut their neighbours, one step further. It stops when nothing intersects, after two rounds
/// without improvement, or after six rounds; the round with the fewest intersections wins. Then
/// narrowing that avoids nothing is taken back.
/// @throws Cancelled when execution's progress says stop.
UncrossedSurface build_uncrossed_surface(const Skeleton& skeleton,
                                         const std::vector<LimbPath>& paths,
                                         const LengthLimits& scale, const SurfaceOptions& options,
                                         const base::Execution& execution = {});

}  // namespace snowbough::tree
