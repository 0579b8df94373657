#pragma once

#include <memory>

#include "gpu/gpu_thread.h"
#include "snow/step/engine.h"

namespace snowbough::snow::gl {

/// How the GL engine deposits snow.
enum class DepositMapping {
  /// Texels gather snow from the sky that they see (DepositPass): smooth, and bit-deterministic.
  kCompute,
  /// Pixels scatter their snow onto the texels under them (DepositGeometryPass): the thesis's
  /// Algorithm 1, for comparison.
  kGeometry,
};

/// All passes and the output as shaders of OpenGL 4.5, on the GPU thread.
std::unique_ptr<Engine> make_engine(std::shared_ptr<gpu::GpuThread> thread, DepositMapping mapping);

}  // namespace snowbough::snow::gl
