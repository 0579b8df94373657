#pragma once

#include <vector>

#include "snow/movement/movement.h"
#include "snow/scene/scene_object.h"
#include "snow/step/engine/engine.h"
#include "snow/step/pass_hashes.h"

namespace snowbough::snow {

/// One step of snow: the fall, the settings that move snow, and the tile size.
struct FrameStep {
  FallSettings fall;
  StabilitySettings stability;
  MovementSettings movement;
  /// Direction of the sun's light, of length 1; 0: none.
  glm::dvec3 sun{0.0};
  /// Seconds.
  double dt = 0.0;
  /// Largest edge of a tile in pixels; changes no result.
  int32_t tile_size = 2048;
  /// Landing needs repose, which shapes the heaps.
  bool moves_snow() const {
    return movement.repose.is_on() && (dt > 0.0 || movement.landing.is_on);
  }
};

/// Runs a step on the engine's current scene, which must be built for `objects`, as must
/// `movement`; passes the positions of moved objects first. `hashes`, if any, receives the passes'
/// hashes. On the engine's thread.
void run_step(Engine& engine, Movement& movement, const std::vector<SceneObject*>& objects,
              const FrameStep& step, std::vector<PassHash>* hashes = nullptr);

}  // namespace snowbough::snow
