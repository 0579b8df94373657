#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "gpu/program_variants.h"
#include "snow/deposit_compute.h"
#include "snow/fall_grid.h"
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

/// What the deposit of the step's last tile left to be shared out.
struct PendingShares {
  /// DepositComputePass::weight_sum and weight_sum_view; null = no tile is pending.
  const gpu::Buffer* weight_sum = nullptr;
  const gpu::BufferTexture* weight_sum_view = nullptr;
  /// The step's FallFrame, and the tile's pixels.
  const gpu::Buffer* fall = nullptr;
  PixelRect tile;
  /// Shares of further tiles wait in the batches' `share`.
  bool earlier_tiles = false;
  /// The whole deposit lies on the groups' `deposit` maps; nothing of the above counts.
  bool on_deposit_maps = false;
};

/// Adds the step's deposit (the batches' `units` and `share`, left at zero, and what is pending in
/// their `steps`) to the height maps and lets slide what the slope cannot hold, in closed form over
/// `dt` seconds; leaves the volumes in the batches' `partials`, as many a work group of texels as
/// there are walkers.
class StabilityPass {
 public:
  /// `walkers`: at most shared::kMostWalkers. GPU thread.
  explicit StabilityPass(int32_t walkers = snow::walkers()) : walkers_(walkers) {}

  /// `snow.depth` is what the step's `units` refer to. Without a pending tile only `units` and
  /// `share` count. GPU thread.
  void run(SceneBuffers& scene, const StabilitySettings& settings, const PendingShares& pending,
           const StepSnow& snow, float dt);

 private:
  int32_t walkers_;
  gpu::ProgramVariants programs_{{"stability.comp.glsl"}};
};

}  // namespace snowbough::snow
