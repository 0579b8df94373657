#pragma once

#include "snow/fall_grid.h"
#include "snow/occlusion.h"
#include "snow/scene_buffers.h"

namespace snowbough::snow {

/// What deposit_weigh.comp.glsl does to a batch, by the same source (shaders/texel_weigh.h) on the
/// processor. Only where gpu::is_software. GPU thread.
void weigh_on_processor(const SceneBuffers& scene, const gpu::Buffer& fall, const Tile& tile,
                        const OcclusionTarget& occlusion, TexelBatch& batch,
                        gpu::Buffer& weight_sum);

}  // namespace snowbough::snow
