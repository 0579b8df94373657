#pragma once

#include "gpu/program.h"
#include "gpu/resources.h"
#include "snow/step/gl/scene_buffers.h"

namespace snowbough::snow {

/// Evaluates every triangle on the current vertices as the fall of this step meets it: corners in
/// pixels of the grid and depth, slopes, area. First pass of a step; all others build on it instead
/// of on vertices.
class TriangleSetupPass {
 public:
  /// Fills the scene's `triangle_corners` and `triangle_surface` (shaders/lib/triangle_setup.h).
  /// `projection` holds the ProjectionFrame. GPU thread.
  void run(SceneBuffers& scene, const gpu::Buffer& projection);

 private:
  gpu::Program program_{{"triangle_setup.comp.glsl"}};
};

}  // namespace snowbough::snow
