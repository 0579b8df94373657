#pragma once

#include <cstdint>

#include "gpu/egl_context.h"

namespace snowbough::snow {

/// Free memory of the GPU in bytes, of the machine where the driver is a software one or does not
/// tell; 0 = unknown. GPU thread.
int64_t available_memory(const gpu::GpuInfo& info);

}  // namespace snowbough::snow
