#include "snow/deposit_geometry.h"

namespace snowbough::snow {
namespace {

/// Additive drawing of points on `framebuffer` until it goes out of scope.
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

/// What texel_target.h asks for.
void bind_texels(gpu::Program& program, const SceneBuffers& scene, const TexelBatch& batch,
                 const gpu::Buffer& fall, const Tile& tile, const OcclusionTarget& occlusion) {
  program.bind("Fall", fall);
  program.bind_texture("triangle_corners", scene.views.triangle_corners);
  program.bind_texture("corner_words", scene.views.corner_words);
  program.bind_texture("triangle_words", scene.views.triangle_words);
  program.bind_texture("triangle_surface", scene.views.triangle_surface);
  program.bind_texture("texels", batch.views.texels);
  program.bind_texture("group_slots", batch.views.group_slots);
  program.bind_texture("fragment_begin", batch.views.fragment_begin);
  program.bind_texture("fragments", batch.views.fragments);
  program.bind_texture("occlusion", occlusion.views.visible);
  program.set("tile_origin", tile.pixels.low);
  program.set("tile_size", tile.pixels.size());
}

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

void DepositGeometryPass::weigh(SceneBuffers& scene, const gpu::Buffer& fall, const Tile& tile,
                                const OcclusionTarget& occlusion) {
  if (weight_map_.width() != occlusion.visible_texture.width() ||
      weight_map_.height() != occlusion.visible_texture.height()) {
    weight_map_ = gpu::Texture(GL_R32F, occlusion.visible_texture.width(),
                               occlusion.visible_texture.height());
    weight_target_ = gpu::Framebuffer({&weight_map_});
  }
  weight_map_.clear();
  const AdditivePoints drawing(weight_target_, vertices_, tile.pixels.size());
  for (const TexelBatch& batch : scene.batches) {
    weigh_.use();
    bind_texels(weigh_, scene, batch, fall, tile, occlusion);
    weigh_.draw(GL_POINTS, 0, batch.count);
  }
}

void DepositGeometryPass::drop_on_pixels(SceneBuffers& scene, const gpu::Buffer& fall,
                                         const Tile& tile, const OcclusionTarget& occlusion) {
  const glm::ivec2 size = tile.pixels.size();
  for (const TexelBatch& batch : scene.batches) {
    const MapGroup& group = scene.groups[static_cast<size_t>(batch.group)];
    const AdditivePoints drawing(group.deposit_target, vertices_, glm::ivec2(group.resolution));
    pixels_.use();
    pixels_.bind("Fall", fall);
    pixels_.bind_texture("triangle_corners", scene.views.triangle_corners);
    pixels_.bind_texture("triangle_words", scene.views.triangle_words);
    pixels_.bind_texture("map_triangles", scene.views.map_triangles);
    pixels_.bind_texture("map_offsets", scene.views.map_offsets);
    pixels_.bind_texture("triangle_surface", scene.views.triangle_surface);
    pixels_.bind_texture("texels", batch.views.texels);
    pixels_.bind_texture("texel_steps", batch.views.step_floats);
    pixels_.bind_texture("occlusion", occlusion.views.visible);
    pixels_.bind_texture("owners", group.owners);
    pixels_.bind_texture("weight_map", weight_map_);
    pixels_.set("group_objects", glm::uvec2(group.first_slot, group.end_slot));
    pixels_.set("batch_texels", glm::uvec2(batch.first, batch.first + batch.count));
    pixels_.set("tile_origin", tile.pixels.low);
    pixels_.set("tile_size", size);
    pixels_.set("map_size", static_cast<float>(group.resolution));
    pixels_.draw(GL_POINTS, 0, size.x * size.y);
  }
}

void DepositGeometryPass::share_out(SceneBuffers& scene, const gpu::Buffer& fall, const Tile& tile,
                                    const OcclusionTarget& occlusion) {
  for (const TexelBatch& batch : scene.batches) {
    const MapGroup& group = scene.groups[static_cast<size_t>(batch.group)];
    const AdditivePoints drawing(group.deposit_target, vertices_, glm::ivec2(group.resolution));
    share_.use();
    bind_texels(share_, scene, batch, fall, tile, occlusion);
    share_.bind_texture("weight_map", weight_map_);
    share_.set("resolution", group.resolution);
    share_.set("map_size", static_cast<float>(group.resolution));
    share_.draw(GL_POINTS, 0, batch.count);
  }
}

void DepositGeometryPass::count(SceneBuffers& scene, const gpu::Buffer& fall, const Tile& tile,
                                const OcclusionTarget& occlusion) {
  const glm::ivec2 size = tile.pixels.size();
  count_.use();
  count_.bind("Fall", fall);
  count_.bind("Counts", scene.pixel_counts);
  count_.bind_texture("occlusion", occlusion.views.visible);
  count_.bind_texture("triangle_words", scene.views.triangle_words);
  count_.set("tile_origin", tile.pixels.low);
  count_.set("tile_size", size);
  count_.dispatch(gpu::group_count(size.x, shared::kRowRun), size.y);
}

void DepositGeometryPass::run(SceneBuffers& scene, const gpu::Buffer& fall, const Tile& tile,
                              const OcclusionTarget& occlusion) {
  weigh(scene, fall, tile, occlusion);
  drop_on_pixels(scene, fall, tile, occlusion);
  share_out(scene, fall, tile, occlusion);
  count(scene, fall, tile, occlusion);
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT);
}

}  // namespace snowbough::snow
