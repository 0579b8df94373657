#pragma once

#include "snow/scene/projection.h"
#include "snow/step/cpu/scene.h"

namespace snowbough::snow::cpu {

/// The deposit of a tile, gathered by the chosen texels (shaders/lib/texel_gain.h, where the method
/// stands): adds what they gain to `gain` of their steps, or sets it where this is the step's first
/// tile, and fills in their `area` and `up`. The scene's `seen` shows the tile and its margin.
void gather_deposit(Scene& scene, const Tile& tile, bool is_first);

}  // namespace snowbough::snow::cpu
