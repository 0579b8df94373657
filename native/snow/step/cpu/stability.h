#pragma once

#include "snow/step/cpu/scene.h"
#include "snow/step/engine.h"

namespace snowbough::snow::cpu {

/// Adds the chosen texels' deposit to their heights and lets slide what the slope cannot hold, in
/// closed form over `dt` seconds (shaders/lib/texel_stability.h, where the method stands); adds up
/// each receiver's volumes and visible area, in a fixed order.
void apply_stability(Scene& scene, const StabilitySettings& settings, float full_gain, float dt);

}  // namespace snowbough::snow::cpu
