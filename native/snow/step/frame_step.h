#pragma once

#include <vector>

#include "snow/scene/projection.h"
#include "snow/scene/scene_object.h"
#include "snow/step/engine/engine.h"

namespace snowbough::snow {

/// One step of snow: the fall, the settings that move snow, and the tile size.
struct FrameStep {
  FallSettings fall;
  StabilitySettings stability;
  ReposeSettings repose;
  /// Seconds.
  double dt = 0.0;
  /// Largest edge of a tile in pixels; changes no result.
  int32_t tile_size = 2048;
};

/// Runs a step on the engine's current scene, which must be built for `objects`; passes the
/// positions of moved objects first. On the engine's thread.
void run_step(Engine& engine, const std::vector<SceneObject*>& objects, const FrameStep& step);

}  // namespace snowbough::snow
