#pragma once

#include "gpu/program.h"
#include "snow/fall_grid.h"
#include "snow/occlusion.h"
#include "snow/scene_buffers.h"
#include "snow/walkers.h"

namespace snowbough::snow {

/// Counts what the sky sees of every receiver: pixels of its front and of its back faces.
class PixelCountsPass {
 public:
  /// `walkers`: at most shared::kMostWalkers. GPU thread.
  explicit PixelCountsPass(int32_t walkers = snow::walkers())
      : program_({"pixel_counts.comp.glsl"}, {walkers_define(walkers)}) {}

  /// Adds a tile's own pixels to the scene's `pixel_counts`. GPU thread.
  void run(SceneBuffers& scene, const Tile& tile, const OcclusionTarget& occlusion);

 private:
  gpu::Program program_;
};

}  // namespace snowbough::snow
