#pragma once

#include <cstdint>
#include <string>

#include "gpu/gl_context.h"

namespace snowbough::snow {

/// Free memory of the GPU in bytes, of the machine where the driver is a software one or does not
/// tell; 0 = unknown. GPU thread.
int64_t available_memory(const gpu::GpuInfo& info);

/// Invocations of a work group in the passes that go along a run of texels or pixels, each taking
/// every so many-th: 64, as GPUs run them together; 8 where the driver is a software renderer (see
/// CONTRIBUTING.md). At most shared::kMaxLocalSize. For the current context. GPU thread.
int32_t local_size();

/// What the shaders of such passes are compiled with.
std::string local_size_define(int32_t local_size);

}  // namespace snowbough::snow
