#pragma once

#include <cstdint>
#include <vector>

#include "tree/surface/limb.h"
#include "tree/surface/surface.h"

namespace snowbough::tree {

/// Wraps the skeleton in quads, by index: each step replaces a quad by a tube, so that the surface
/// is closed and consistently wound for every skeleton, with one component per root. Nothing is
/// welded. Keeps the limbs, so that rebuilding the surface with other narrowing steps only rebuilds
/// the limbs that change.
///
/// Method: D. T. Reynolds, PhD thesis, University of East Anglia, 2014, section 3.3, "knuckles".
class SurfaceBuilder {
 public:
  /// Skeleton and paths must outlive the builder.
  /// @param paths  limb_paths(skeleton).
  /// @param threads  that may share the work, the calling one included; 0 = one per core. Does not
  ///   change the surface.
  SurfaceBuilder(const Skeleton& skeleton, const std::vector<LimbPath>& paths,
                 const SurfaceScale& scale, const SurfaceOptions& options, int threads = 0);

  /// Builds the limbs; later calls rebuild only those that change.
  /// @param narrowing_steps  per branch, 0 by default: how often its base was narrowed and freed of
  ///   rings because it intersected other faces.
  void build(const std::vector<uint8_t>& narrowing_steps);

  /// Joins the limbs to a surface.
  /// @param only  per branch, 0 leaves it out, together with its descendants: for examining a part
  ///   of the surface, whose faces are the same as in the whole. Of a branch left out only the
  ///   first ring exists, by its vertices, if its parent is there. Empty = all.
  Surface surface(const std::vector<uint8_t>& only = {}) const;

 private:
  const LimbStart& start_of(int32_t branch) const;
  void rebuild_limb(int32_t branch, const std::vector<uint8_t>& narrowing_steps,
                    std::vector<uint8_t>& dirty);

  LimbPlan plan_;
  int threads_;
  /// Branches by depth below the root.
  std::vector<std::vector<int32_t>> generations_;
  std::vector<LimbPart> parts_;
  /// Narrowing steps of parts_; empty before the first build.
  std::vector<uint8_t> narrowing_steps_;
};

}  // namespace snowbough::tree
