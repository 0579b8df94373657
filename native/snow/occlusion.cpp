#include "snow/occlusion.h"

#include <algorithm>

namespace snowbough::snow {

void OcclusionTarget::require_size(glm::ivec2 size) {
  if (visible.id() != 0 && size.x <= visible.width() && size.y <= visible.height()) {
    return;
  }
  const auto rounded = [](int32_t wanted, int32_t have) {
    return std::max((wanted + 127) / 128 * 128, have);
  };
  const int32_t width = rounded(size.x, visible.width());
  const int32_t height = rounded(size.y, visible.height());
  visible = gpu::Texture(GL_RGBA32UI, width, height);
  depth = gpu::Texture(GL_DEPTH_COMPONENT32F, width, height);
  framebuffer = gpu::Framebuffer({&visible}, &depth);
}

void OcclusionPass::run(const SceneBuffers& scene, const gpu::Buffer& fall, const Tile& tile,
                        const std::vector<TriangleRange>& ranges, OcclusionTarget& target) {
  const glm::ivec2 size = tile.pixels.size();
  target.require_size(size);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, target.framebuffer.id());
  glBindVertexArray(vertices_.id());
  glDisable(GL_BLEND);
  glDisable(GL_CULL_FACE);
  glEnable(GL_DEPTH_TEST);
  glDepthMask(GL_TRUE);
  glDepthFunc(GL_LESS);
  // The viewport is the same for all tiles of a block, the scissor cuts out this one.
  glEnable(GL_SCISSOR_TEST);
  glScissor(0, 0, size.x, size.y);
  const GLuint nothing[4] = {0, 0, 0, 0};
  const GLfloat far_away = 1.0f;
  glClearBufferuiv(GL_COLOR, 0, nothing);
  glClearBufferfv(GL_DEPTH, 0, &far_away);
  glViewport(tile.viewport_origin.x - tile.pixels.low.x, tile.viewport_origin.y - tile.pixels.low.y,
             kViewportSize, kViewportSize);

  program_.use();
  program_.bind("Fall", fall);
  program_.bind_texture("positions", scene.views.positions);
  program_.bind_texture("triangles", scene.views.triangles);
  program_.bind_texture("triangle_surface", scene.views.triangle_surface);
  program_.set("viewport_origin", glm::vec2(tile.viewport_origin));
  program_.set("viewport_size", static_cast<float>(kViewportSize));
  program_.set("tile_origin", tile.pixels.low);
  for (const TriangleRange& range : ranges) {
    program_.draw(GL_TRIANGLES, 3 * range.first, 3 * range.count);
  }
  glDisable(GL_SCISSOR_TEST);
  glDisable(GL_DEPTH_TEST);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
}

}  // namespace snowbough::snow
