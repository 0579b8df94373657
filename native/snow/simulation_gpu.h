#pragma once

#include "snow/simulation.h"

namespace snowbough::snow {

/// All that a simulation keeps on the GPU, made and destroyed there.
struct SnowSimulation::Gpu {
  SceneBuffers scene;
  FrameStep frame_step;
};

}  // namespace snowbough::snow
