#pragma once

#include <vector>

#include "snow/scene/projection.h"
#include "snow/scene/scene_object.h"
#include "snow/step/engine.h"

namespace snowbough::snow {

/// One frame of snow, from vertices to heights: what falls, how long it may slide, and how the work
/// is cut.
struct FrameStep {
  FallSettings fall;
  StabilitySettings stability;
  ReposeSettings repose;
  /// Seconds.
  double dt = 0.0;
  /// Largest edge of a tile in pixels; it changes no result.
  int32_t tile_size = 2048;
};

/// Lets an engine do a step on the scene that it has laid out for `objects`; positions of those
/// that moved are handed over first. On the engine's thread.
void run_step(Engine& engine, const std::vector<SceneObject*>& objects, const FrameStep& step);

}  // namespace snowbough::snow
