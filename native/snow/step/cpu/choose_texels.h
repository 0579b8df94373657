#pragma once

#include "snow/step/cpu/scene.h"

namespace snowbough::snow::cpu {

/// Chooses the groups of texels that have anything to do in this step: those on which snow lies or
/// which have a triangle that faces the fall. The passes would change nothing on the others.
void choose_texels(Scene& scene);

}  // namespace snowbough::snow::cpu
