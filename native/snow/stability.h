#pragma once

#include "gpu/program.h"
#include "snow/fall_grid.h"
#include "snow/scene_buffers.h"

namespace snowbough::snow {

/// What decides how much snow a slope holds.
struct StabilitySettings {
  /// Thickness in metres that level ground holds; a slope holds max_depth * (normal . up).
  float max_depth = 1.0f;
  /// Seconds in which what is too much halves.
  float half_life = 2.0f;
};

/// What the deposit of the step's last tile left to be shared out.
struct PendingShares {
  /// DepositComputePass::pixel_share; null = no tile is pending.
  const gpu::Texture* pixel_share = nullptr;
  /// Shares of further tiles wait in the batches' `share`.
  bool earlier_tiles = false;
  /// The whole deposit lies on the groups' `deposit` maps; nothing of the above counts.
  bool on_deposit_maps = false;
};

/// Adds the step's deposit (the batches' `units` and `share`, left at zero, and what is pending) to
/// the height maps and lets slide what the slope cannot hold, in closed form over `dt` seconds;
/// leaves the volumes in the batches' `partials`.
class StabilityPass {
 public:
  /// `step_depth` is the depth that the step's `units` refer to, metres. Without a pending tile
  /// only `units` and `share` count. GPU thread.
  void run(SceneBuffers& scene, const StabilitySettings& settings, const PendingShares& pending,
           float step_depth, float dt);

 private:
  gpu::Program& program_for(const PendingShares& pending);

  gpu::Program deposit_map_{{"stability.comp.glsl"}, {"DEPOSIT_MAP"}};
  gpu::Program shares_waiting_{{"stability.comp.glsl"}, {"EARLIER_TILES"}};
  gpu::Program last_tile_{{"stability.comp.glsl"}, {"LAST_TILE"}};
  gpu::Program all_tiles_{{"stability.comp.glsl"}, {"LAST_TILE", "EARLIER_TILES"}};
};

}  // namespace snowbough::snow
