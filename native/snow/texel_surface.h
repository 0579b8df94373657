#pragma once

#include <vector>

#include "gpu/program.h"
#include "snow/occlusion.h"
#include "snow/scene_buffers.h"

namespace snowbough::snow {

/// Evaluates triangles and texels on the current vertices: normals, areas, positions, covered
/// areas. GPU thread.
class TexelSurfacePass {
 public:
  /// The triangles of the objects in `moved` (indices in drawing order, ascending).
  void run_triangles(SceneBuffers& scene, const std::vector<int32_t>& moved);
  /// The texels of the batches' `old_groups`.
  void run_texels(SceneBuffers& scene);

 private:
  gpu::Program triangles_{{"triangle_surface.comp.glsl"}};
  gpu::Program texels_{{"texel_surface.comp.glsl"}};
};

}  // namespace snowbough::snow
