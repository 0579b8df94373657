#pragma once

#include <memory>

#include "gpu/gpu_thread.h"
#include "snow/step/engine/engine.h"
#include "snow/step/engine/engine_request.h"

namespace snowbough::snow::gl {

/// All passes and the output as shaders of OpenGL 4.5, on the GPU thread.
std::unique_ptr<Engine> make_engine(std::shared_ptr<gpu::GpuThread> thread, DepositMapping mapping);

}  // namespace snowbough::snow::gl
