#pragma once

#include <cstdint>
#include <vector>

#include "tree/surface/limb.h"
#include "tree/surface/surface.h"

namespace snowbough::tree {

/// Builds a surface limb by limb (see build_surface) and keeps the limbs, so that rebuilding it
/// with other narrowing steps only rebuilds the limbs that change.
class SurfaceBuilder {
 public:
  /// Skeleton and paths must outlive the builder.
  /// @param threads  that may share the work, the calling one included; 0 = one per core. Does not
  ///   change the surface.
  SurfaceBuilder(const Skeleton& skeleton, const std::vector<LimbPath>& paths,
                 const SurfaceScale& scale, const SurfaceOptions& options, int threads = 0);

  /// Builds the limbs; later calls rebuild only those that change.
  /// @param narrowing_steps  see build_surface.
  void build(const std::vector<uint8_t>& narrowing_steps);

  /// Joins the limbs to a surface.
  /// @param only  see build_surface.
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
