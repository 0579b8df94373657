#include "snow/step/gl/passes.h"

namespace snowbough::snow {

void BackPixelsPass::run(SceneBuffers& scene, const Tile& tile, const OcclusionTarget& occlusion) {
  const glm::ivec2 own = tile.pixels.size();
  program_.use();
  program_.bind("BackPixels", scene.back_pixels);
  program_.bind_texture("occlusion", occlusion.views.visible);
  program_.bind_texture("triangle_words", scene.views.triangle_words);
  program_.set("tile_size", tile.with_margin().size());
  program_.dispatch(gpu::group_count(own.x, shared::kRowRun), own.y);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

}  // namespace snowbough::snow
