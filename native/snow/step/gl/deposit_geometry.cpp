#include "snow/step/gl/passes.h"

namespace snowbough::snow {
namespace {

/// Enables additive drawing of points on `framebuffer` within its scope.
class AdditivePoints {
 public:
  AdditivePoints(const gpu::Framebuffer& framebuffer, const gpu::VertexArray& vertices,
                 glm::ivec2 size) {
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer.id());
    glBindVertexArray(vertices.id());
    glViewport(0, 0, size.x, size.y);
    glDisable(GL_DEPTH_TEST);
    glEnable(GL_PROGRAM_POINT_SIZE);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE);
    glBlendEquation(GL_FUNC_ADD);
  }
  ~AdditivePoints() {
    glDisable(GL_BLEND);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
  }
  AdditivePoints(const AdditivePoints&) = delete;
  AdditivePoints& operator=(const AdditivePoints&) = delete;
};

}  // namespace

void DepositGeometryPass::begin(SceneBuffers& scene) {
  for (MapGroup& group : scene.groups) {
    if (group.deposit.id() == 0) {
      group.deposit = gpu::Texture(GL_R32F, group.resolution, group.resolution, group.layers());
      group.deposit_target = gpu::Framebuffer({&group.deposit});
    } else {
      group.deposit.clear();
    }
  }
}

void DepositGeometryPass::run(SceneBuffers& scene, const gpu::Buffer& projection, const Tile& tile,
                              const OcclusionTarget& occlusion) {
  const PixelRect shown = tile.with_margin();
  for (const TexelBatch& batch : scene.batches) {
    const MapGroup& group = scene.groups[static_cast<size_t>(batch.group)];
    const AdditivePoints drawing(group.deposit_target, vertices_, glm::ivec2(group.resolution));
    program_.use();
    program_.bind("Projection", projection);
    program_.bind_texture("triangle_corners", scene.views.triangle_corners);
    program_.bind_texture("triangle_words", scene.views.triangle_words);
    program_.bind_texture("map_triangles", scene.views.map_triangles);
    program_.bind_texture("map_offsets", scene.views.map_offsets);
    program_.bind_texture("places", batch.views.places);
    program_.bind_texture("texel_steps", batch.views.steps);
    program_.bind_texture("occlusion", occlusion.views.visible);
    program_.bind_texture("owners", group.owners);
    program_.set("group_objects", glm::uvec2(group.first_slot, group.end_slot));
    program_.set("batch_texels", glm::uvec2(batch.first, batch.first + batch.count));
    program_.set("tile_origin", shown.low);
    program_.set("tile_size", shown.size());
    program_.set("map_size", static_cast<float>(group.resolution));
    program_.draw(GL_POINTS, 0, shown.size().x * shown.size().y);
  }
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
}

}  // namespace snowbough::snow
