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
/// `partials`, one an invocation: `local_size` a work group of texels.
class StabilityPass {
 public:
  /// `local_size`: at most shared::kMaxLocalSize. GPU thread.
  explicit StabilityPass(int32_t local_size = snow::local_size()) : local_size_(local_size) {}

  /// `full_gain`: thickness in metres that a texel which gains shared::kGainUnits is given.
  /// `on_deposit_maps`: the deposit lies on the groups' `deposit` maps instead. GPU thread.
  void run(SceneBuffers& scene, const StabilitySettings& settings, float full_gain, float dt,
           bool on_deposit_maps = false);

 private:
  int32_t local_size_;
  gpu::ProgramVariants programs_{{"stability.comp.glsl"}};
};

}  // namespace snowbough::snow
