#pragma once

#include "snow/stability.h"

namespace snowbough::snow {

/// What stability.comp.glsl does to a batch, by the same source (shaders/texel_settle.h) on the
/// processor, for scenes whose kernels run there. `partials` parts of a work group's texels have
/// sums of their own. GPU thread.
void settle_on_processor(SceneBuffers& scene, const StabilitySettings& settings, float full_gain,
                         float dt, TexelBatch& batch, int32_t partials);

}  // namespace snowbough::snow
