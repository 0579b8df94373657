#pragma once

#include "snow/fall_grid.h"
#include "snow/occlusion.h"
#include "snow/scene_buffers.h"

namespace snowbough::snow {

/// What deposit_pixels.comp.glsl does for a map group, on the processor, for scenes whose kernels
/// run there. `list_size`: a shared::ListSize; `list`: room for all of the tile's pixels. GPU
/// thread.
void list_pixels_on_processor(SceneBuffers& scene, const MapGroup& group, const gpu::Buffer& fall,
                              const Tile& tile, const OcclusionTarget& occlusion,
                              const gpu::Buffer& weight_sum, gpu::Buffer& list_size,
                              gpu::Buffer& list);

}  // namespace snowbough::snow
