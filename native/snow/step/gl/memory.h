#pragma once

#include <cstdint>
#include <vector>

#include "snow/scene/memory_estimate.h"

namespace snowbough::snow::gl {

/// Bytes that build_scene_buffers and a tile of `tile_size` pixels will allocate.
MemoryEstimate estimate_memory(const std::vector<const SceneObject*>& objects, int32_t tile_size);

}  // namespace snowbough::snow::gl
