#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "tree/skeleton/skeleton.h"
#include "tree/surface/limb_path.h"

namespace snowbough::tree {

/// The stretch along which two stems of similar thickness separate. From the heel on, the child's
/// outer side rises from its parent; at the crotch both limbs are apart. Arc lengths on the child's
/// own path and on the parent's.
struct Crotch {
  double child_heel = 0.0, child_end = 0.0;
  double parent_heel = 0.0, parent_end = 0.0;
  /// Where the child's outer side first rises from its parent: before the heel of stems that lie
  /// side by side for long.
  double parent_rise = 0.0;
};

/// The crotch between a limb and a child that leaves it as a second stem: with at least half of its
/// radius, at less than 45 degrees. None for other children, and for one that does not leave its
/// parent.
///
/// Stems that lie side by side for long have their heel a few radii before their end: up to there
/// they are one limb.
/// @param search  of the parent's path.
/// @param attach  arc length of the child's attach point on the parent's path.
std::optional<Crotch> find_crotch(const PathSearch& search, double attach, const LimbPath& child,
                                  const LengthLimits& scale);

/// The paths that the surface follows: up to the heel of a stem beside it, a limb has the area of
/// both, and their middle. Bone lengths stay those of the limb's own centreline.
std::vector<LimbPath> join_stems(const Skeleton& skeleton, std::vector<LimbPath> paths,
                                 const LengthLimits& scale);

/// Per branch: the limb that it leaves on the surface, or -1. Of several stems that separate from
/// one parent, one that stays within another longer than within their parent leaves that one. What
/// leaves a stem before its heel leaves that stem's parent; all other branches leave their parent
/// in the skeleton.
std::vector<int32_t> surface_parents(const Skeleton& skeleton, const std::vector<LimbPath>& paths,
                                     const LengthLimits& scale);

}  // namespace snowbough::tree
