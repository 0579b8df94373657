#pragma once

#include <string>
#include <vector>

#include "gpu/program_variants.h"
#include "snow/step/engine.h"
#include "snow/step/gl/scene_buffers.h"
#include "snow/step/gl/work_group_size.h"

namespace snowbough::snow {

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
