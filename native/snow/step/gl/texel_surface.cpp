#include "snow/step/gl/passes.h"

namespace snowbough::snow {

void TexelSurfacePass::run(SceneBuffers& scene) {
  for (TexelBatch& batch : scene.batches) {
    program_.use();
    program_.bind_texture("groups", batch.views.active_groups);
    program_.bind_texture("triangle_surface", scene.views.triangle_surface);
    program_.bind_texture("fragment_begin", batch.views.fragment_begin);
    program_.bind_texture("fragments", batch.views.fragments);
    program_.bind("TexelSteps", batch.steps);
    program_.dispatch_indirect(batch.active_groups, kBlocks);
  }
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
}

}  // namespace snowbough::snow
