#pragma once

#include "gpu/program.h"
#include "snow/scene_buffers.h"

namespace snowbough::snow {

/// What decides how much snow a slope holds.
struct StabilitySettings {
  /// Thickness in metres that level ground holds; a slope holds max_depth * (normal . up).
  float max_depth = 1.0f;
  /// Seconds in which what is too much halves.
  float half_life = 2.0f;
};

/// Adds the step's deposit (the batches' `share` and `units`, left at zero) to the height maps and
/// lets slide what the slope cannot hold, in closed form over `dt` seconds; leaves each work
/// group's volumes in the batches' `partials`.
class StabilityPass {
 public:
  /// `step_depth` is the depth that one step's `units` refer to, metres. GPU thread.
  void run(SceneBuffers& scene, const StabilitySettings& settings, float step_depth, float dt);

 private:
  gpu::Program program_{{"stability.comp.glsl"}};
};

}  // namespace snowbough::snow
