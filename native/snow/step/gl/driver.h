#pragma once

#include <cstdint>
#include <string>

#include "gpu/gl_context.h"

namespace snowbough::snow {

/// Free memory of the GPU in bytes; of the machine if the driver is a software renderer or does not
/// report it; 0 = unknown. GPU thread.
int64_t available_memory(const gpu::GpuInfo& info);

/// Work-group size of passes in which each invocation takes every n-th texel or pixel of a run: 64,
/// as GPUs run them together; 8 on software renderers (docs/dev/shaders.md). At most
/// shared::kMaxLocalSize. For the current context. GPU thread.
int32_t local_size();

/// The define with which the shaders of such passes are compiled.
std::string local_size_define(int32_t local_size);

}  // namespace snowbough::snow
