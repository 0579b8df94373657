#include <string>
#include <vector>

#include "snow/step/gl/passes.h"

namespace snowbough::snow {

void TexelSurfacePass::run(SceneBuffers& scene) {
  const bool has_shading = scene.smooth_point_count > 0;
  std::vector<std::string> defines;
  if (has_shading) defines.emplace_back("WITH_SHADING");
  gpu::Program& program = programs_.with(defines);
  for (TexelBatch& batch : scene.batches) {
    program.use();
    if (has_shading) {
      program.bind_texture("triangle_points", scene.views.triangle_points);
      program.bind_texture("smooth_points", scene.views.smooth_points);
    }
    program.bind_texture("groups", batch.views.active_groups);
    program.bind_texture("triangle_surface", scene.views.triangle_surface);
    program.bind_texture("fragment_begin", batch.views.fragment_begin);
    program.bind_texture("fragments", batch.views.fragments);
    program.bind("TexelSteps", batch.steps);
    program.dispatch_indirect(batch.active_groups, kBlocks);
  }
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
}

}  // namespace snowbough::snow
