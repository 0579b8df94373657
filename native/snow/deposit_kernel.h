#pragma once

#include "snow/fall_grid.h"
#include "snow/occlusion.h"
#include "snow/scene_buffers.h"

namespace snowbough::snow {

/// What deposit.comp.glsl does to a batch, by the same source (shaders/texel_gain.h) on the
/// processor, for scenes whose kernels run there. GPU thread.
void deposit_on_processor(const SceneBuffers& scene, const gpu::Buffer& fall, const Tile& tile,
                          const OcclusionTarget& occlusion, bool is_first, TexelBatch& batch);

}  // namespace snowbough::snow
