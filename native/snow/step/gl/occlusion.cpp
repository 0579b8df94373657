#include "snow/step/gl/occlusion.h"

#include <algorithm>
#include <bit>
#include <string>

namespace snowbough::snow {

void OcclusionTarget::require_size(glm::ivec2 size) {
  const int64_t bytes = static_cast<int64_t>(sizeof(shared::SeenPixel)) * size.x * size.y;
  if (visible.bytes() < bytes) {
    visible = gpu::Buffer(bytes);
    views.visible = gpu::BufferTexture(visible, GL_RG32UI);
  }
  if (visible_texture.id() != 0 && size.x <= visible_texture.width() &&
      size.y <= visible_texture.height()) {
    return;
  }
  const auto rounded = [](int32_t wanted, int32_t have) {
    return std::max((wanted + 127) / 128 * 128, have);
  };
  const int32_t width = rounded(size.x, visible_texture.width());
  const int32_t height = rounded(size.y, visible_texture.height());
  visible_texture = gpu::Texture(GL_RG32UI, width, height);
  depth_texture = gpu::Texture(GL_DEPTH_COMPONENT32F, width, height);
  framebuffer = gpu::Framebuffer({&visible_texture}, &depth_texture);
}

void OcclusionTarget::copy_pixels(glm::ivec2 size) {
  glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer.id());
  glBindBuffer(GL_PIXEL_PACK_BUFFER, visible.id());
  glReadPixels(0, 0, size.x, size.y, GL_RG_INTEGER, GL_UNSIGNED_INT, nullptr);
  glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, 0);
}

void OcclusionPass::use(gpu::Program& program, const SceneBuffers& scene,
                        const gpu::Buffer& projection, const Tile& tile) {
  program.use();
  program.bind("Projection", projection);
  program.bind_texture("triangle_corners", scene.views.triangle_corners);
  program.set("viewport_origin", glm::vec2(tile.viewport_origin));
  program.set("viewport_size", static_cast<float>(kViewportSize));
  program.set("tile_origin", tile.with_margin().low);
  if (&program != &program_) {
    program.bind_texture("alpha_triangles", scene.views.alpha_triangles);
    program.bind_texture("alpha_headers", scene.views.alpha_headers);
    program.bind_texture("alpha_bits", scene.views.alpha_bits);
  }
}

void OcclusionPass::run(const SceneBuffers& scene, const gpu::Buffer& projection, const Tile& tile,
                        const std::vector<TriangleRange>& ranges, OcclusionTarget& target) {
  const PixelRect shown = tile.with_margin();
  const glm::ivec2 size = shown.size();
  target.require_size(size);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, target.framebuffer.id());
  glBindVertexArray(vertices_.id());
  glDisable(GL_BLEND);
  glDisable(GL_CULL_FACE);
  glEnable(GL_DEPTH_TEST);
  glDepthMask(GL_TRUE);
  glDepthFunc(GL_LESS);
  // The viewport is shared by all tiles of a block; the scissor selects this one.
  glEnable(GL_SCISSOR_TEST);
  glScissor(0, 0, size.x, size.y);
  const GLuint nothing[4] = {0, std::bit_cast<GLuint>(shared::kOpenSky), 0, 0};
  const GLfloat far_away = 1.0f;
  glClearBufferuiv(GL_COLOR, 0, nothing);
  glClearBufferfv(GL_DEPTH, 0, &far_away);
  glViewport(tile.viewport_origin.x - shown.low.x, tile.viewport_origin.y - shown.low.y,
             kViewportSize, kViewportSize);

  gpu::Program* used = nullptr;
  for (const TriangleRange& range : ranges) {
    if (range.has_alpha && alpha_program_ == nullptr) {
      alpha_program_ = std::make_unique<gpu::Program>(
          std::vector<std::string>{"occlusion.vert.glsl", "occlusion.frag.glsl"},
          std::vector<std::string>{"WITH_ALPHA"});
    }
    gpu::Program& program = range.has_alpha ? *alpha_program_ : program_;
    if (used != &program) {
      used = &program;
      use(program, scene, projection, tile);
    }
    if (range.has_alpha) {
      program.set("alpha_offset", range.alpha_offset);
    }
    program.draw(GL_TRIANGLES, 3 * range.first, 3 * range.count);
  }
  glDisable(GL_SCISSOR_TEST);
  glDisable(GL_DEPTH_TEST);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
  target.copy_pixels(size);
}

}  // namespace snowbough::snow
