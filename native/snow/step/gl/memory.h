#pragma once

#include <cstdint>
#include <vector>

#include "snow/scene/memory_estimate.h"

namespace snowbough::snow::gl {

/// Bytes that build_scene_buffers, a tile of `tile_size` pixels and, if snow moves,
/// build_repose_buffers will allocate.
MemoryEstimate estimate_memory(const std::vector<const SceneObject*>& objects, int32_t tile_size,
                               bool moves_snow);

}  // namespace snowbough::snow::gl
