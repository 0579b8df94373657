#pragma once

#include <vector>

#include "snow/scene/scene_object.h"
#include "snow/step/engine/engine.h"
#include "snow/step/pass_hashes.h"

namespace snowbough::snow {

/// Runs a step on the engine's current scene, which must be built for `objects`; passes the
/// positions of moved objects first. `hashes`, if any, receives the passes' hashes. On the engine's
/// thread.
void run_step(Engine& engine, const std::vector<SceneObject*>& objects, const FrameStep& step,
              std::vector<PassHash>* hashes = nullptr);

}  // namespace snowbough::snow
