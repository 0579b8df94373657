#pragma once

#include "gpu/program.h"
#include "snow/step/gl/scene_buffers.h"

namespace snowbough::snow {

/// Evaluates texels on the current triangles: covered area and upward part. Only for steps without
/// DepositComputePass, which does so on its way.
class TexelSurfacePass {
 public:
  /// Fills in `area` and `up` of the batches' `steps`, in their `active_groups`. GPU thread.
  void run(SceneBuffers& scene);

 private:
  gpu::Program program_{{"texel_surface.comp.glsl"}};
};

}  // namespace snowbough::snow
