#pragma once

#include <vector>

#include "gpu/program.h"
#include "snow/occlusion.h"
#include "snow/scene_buffers.h"

namespace snowbough::snow {

/// Evaluates triangles and texels on the current vertices: normals, areas, positions, covered
/// areas.
class TexelSurfacePass {
 public:
  /// Recomputes what the objects in `moved` (indices in drawing order, ascending) carry. GPU
  /// thread.
  void run(SceneBuffers& scene, const std::vector<int32_t>& moved);

 private:
  gpu::Program triangles_{{"triangle_surface.comp.glsl"}};
  gpu::Program texels_{{"texel_surface.comp.glsl"}};
};

}  // namespace snowbough::snow
