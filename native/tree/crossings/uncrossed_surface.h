#pragma once

#include <vector>

#include "base/parallel_for.h"
#include "tree/surface/surface.h"

namespace snowbough::tree {

struct UncrossedSurface {
  Surface surface;
  /// Children whose junction still has faces that cross each other.
  std::vector<int32_t> crossing;
  /// Branches whose base had to be narrowed to get clear of others.
  std::vector<int32_t> narrowed;
};

/// build_surface, repeated for the few junctions whose faces cross each other: the branches that
/// cross there are narrowed at their base, their first ring is moved out, and rings that cut their
/// neighbours are left out, a step further each round, until nothing crosses, two rounds in a row
/// bring nothing, or six are over. The round with the fewest crossings wins. Only the branches
/// around those junctions are built anew in each round.
/// @throws Cancelled when execution's progress says stop.
UncrossedSurface build_uncrossed_surface(const Skeleton& skeleton,
                                         const std::vector<LimbPath>& paths,
                                         const SurfaceScale& scale, const SurfaceOptions& options,
                                         const base::Execution& execution = {});

}  // namespace snowbough::tree
