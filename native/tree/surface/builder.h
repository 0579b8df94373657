#pragma once

#include <cstdint>
#include <vector>

#include "tree/surface/limb_path.h"
#include "tree/surface/surface.h"

namespace snowbough::tree {

/// Wraps the skeleton in quads, by index: each step replaces a quad by a tube, so that the surface
/// is closed and consistently wound for every skeleton, with one component per root. Nothing is
/// welded.
///
/// Method: D. T. Reynolds, PhD thesis, University of East Anglia, 2014, section 3.3, "knuckles".
/// @param paths  limb_paths(skeleton).
/// @param narrowing_steps  per branch, 0 by default: how often its base was narrowed and freed of
///   rings because it intersected other faces.
/// @param threads  that may share the work, the calling one included; 0 = one per core. Does not
///   change the surface.
Surface build_surface(const Skeleton& skeleton, const std::vector<LimbPath>& paths,
                      const LengthLimits& scale, const SurfaceOptions& options,
                      const std::vector<uint8_t>& narrowing_steps, int threads = 0);

}  // namespace snowbough::tree
