#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "gpu/program_variants.h"
#include "snow/scene_buffers.h"
#include "snow/walkers.h"

namespace snowbough::snow {

/// What decides how much snow a slope holds.
struct StabilitySettings {
  /// Thickness in metres that level ground holds; a slope holds max_depth * (normal . up).
  float max_depth = 1.0f;
  /// Seconds in which what is too much halves.
  float half_life = 2.0f;
};

/// The half-life that is reckoned with: so short a one is as good as none.
inline float reckoned_half_life(const StabilitySettings& settings) {
  return std::max(settings.half_life, 1e-6f);
}

/// Adds the step's deposit (`gain` of the batches' `steps`) to the height maps and lets slide what
/// the slope cannot hold, in closed form over `dt` seconds; leaves the volumes in the batches'
/// `partials`, as many a work group of texels as there are walkers.
class StabilityPass {
 public:
  /// `walkers`: at most shared::kMostWalkers. GPU thread.
  explicit StabilityPass(int32_t walkers = snow::walkers()) : walkers_(walkers) {}

  /// `full_gain`: thickness in metres that a texel which gains shared::kGainUnits is given.
  /// `on_deposit_maps`: the deposit lies on the groups' `deposit` maps instead. GPU thread.
  void run(SceneBuffers& scene, const StabilitySettings& settings, float full_gain, float dt,
           bool on_deposit_maps = false);

 private:
  int32_t walkers_;
  gpu::ProgramVariants programs_{{"stability.comp.glsl"}};
};

}  // namespace snowbough::snow
