#pragma once

#include "snow/step/cpu/scene.h"

namespace snowbough::snow::cpu {

/// Evaluates area and upward part of the chosen texels on the current triangles, in steps in which
/// nothing falls; sets what they gain to 0.
void evaluate_texels(Scene& scene);

}  // namespace snowbough::snow::cpu
