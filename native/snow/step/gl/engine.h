#pragma once

#include <memory>

#include "gpu/gpu_thread.h"
#include "snow/step/engine.h"

namespace snowbough::snow::gl {

/// How the GL engine lays snow.
enum class DepositMapping {
  /// Texels gather what they see of the sky (DepositPass): smooth, and bit-deterministic.
  kCompute,
  /// Pixels scatter their snow onto the texels under them (DepositGeometryPass): the thesis's
  /// Algorithm 1, for comparison.
  kGeometry,
};

/// All passes as shaders of OpenGL 4.5, output's too, on the GPU thread.
std::unique_ptr<Engine> make_engine(std::shared_ptr<gpu::GpuThread> thread, DepositMapping mapping);

}  // namespace snowbough::snow::gl
