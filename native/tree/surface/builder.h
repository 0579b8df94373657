#pragma once

#include <cstdint>
#include <vector>

#include "tree/surface/limb.h"
#include "tree/surface/surface.h"

namespace snowbough::tree {

/// Builds a surface limb by limb (see build_surface) and keeps the limbs, so that the same surface
/// with other relief costs only what comes out differently.
class SurfaceBuilder {
 public:
  /// Skeleton and paths must outlive the builder.
  /// @param threads  that may share the work, the calling one included; 0 = one a core. The surface
  ///   does not depend on it.
  SurfaceBuilder(const Skeleton& skeleton, const std::vector<LimbPath>& paths,
                 const SurfaceScale& scale, const SurfaceOptions& options, int threads = 0);

  /// Builds the limbs; again only those that come out differently.
  /// @param relief  see build_surface.
  void build(const std::vector<uint8_t>& narrowing_steps);

  /// The limbs put together.
  /// @param only  see build_surface.
  Surface surface(const std::vector<uint8_t>& only = {}) const;

 private:
  const LimbStart& start_of(int32_t branch) const;
  void rebuild_limb(int32_t branch, const std::vector<uint8_t>& narrowing_steps,
                    std::vector<uint8_t>& dirty);

  LimbPlan plan_;
  int threads_;
  /// Branches by their depth below the root.
  std::vector<std::vector<int32_t>> generations_;
  std::vector<LimbPart> parts_;
  /// What parts_ were built with; empty before the first time.
  std::vector<uint8_t> narrowing_steps_;
};

}  // namespace snowbough::tree
