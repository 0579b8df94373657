#pragma once

#include <memory>

#include "gpu/gpu_thread.h"
#include "snow/step/engine/engine.h"

namespace snowbough::snow::gl {

/// All passes and the output as shaders of OpenGL 4.5, on the GPU thread.
/// @param scatters  deposit by GeometryDeposit instead of DepositPass.
std::unique_ptr<Engine> make_engine(std::shared_ptr<gpu::GpuThread> thread, bool scatters = false);

}  // namespace snowbough::snow::gl
