#include "snow/step/gl/passes.h"

namespace snowbough::snow {

void DepositPass::run(SceneBuffers& scene, const gpu::Buffer& projection, const Tile& tile,
                      const OcclusionTarget& occlusion, bool has_noise, bool is_first) {
  const PixelRect shown = tile.with_margin();
  for (TexelBatch& batch : scene.batches) {
    const bool has_opacity = batch.fragment_opacity.id() != 0;
    std::vector<std::string> defines;
    if (!has_noise) defines.emplace_back("WITHOUT_NOISE");
    if (has_opacity) defines.emplace_back("WITH_OPACITY");
    const bool has_shading = scene.smooth_point_count > 0;
    if (has_shading) defines.emplace_back("WITH_SHADING");
    gpu::Program& program = programs_.with(defines);
    program.use();
    program.bind("Projection", projection);
    program.bind_texture("groups", batch.views.active_groups);
    program.bind_texture("group_slots", batch.views.group_slots);
    program.bind_texture("map_offsets", scene.views.map_offsets);
    program.bind_texture("triangle_corners", scene.views.triangle_corners);
    program.bind_texture("triangle_surface", scene.views.triangle_surface);
    program.bind_texture("triangle_sheets", scene.views.triangle_sheets);
    program.bind_texture("map_triangles", scene.views.map_triangles);
    program.bind_texture("fragment_begin", batch.views.fragment_begin);
    program.bind_texture("fragments", batch.views.fragments);
    if (has_opacity) program.bind_texture("fragment_opacity", batch.views.fragment_opacity);
    if (has_shading) {
      program.bind_texture("triangle_points", scene.views.triangle_points);
      program.bind_texture("smooth_points", scene.views.smooth_points);
    }
    program.bind_texture("occlusion", occlusion.views.visible);
    program.bind("TexelSteps", batch.steps);
    program.set("tile_origin", shown.low);
    program.set("tile_size", shown.size());
    program.set("adds_to_gain", is_first ? 0 : 1);
    program.set("resolution",
                static_cast<float>(scene.groups[static_cast<size_t>(batch.group)].resolution));
    program.dispatch_indirect(batch.active_groups, kBlocks);
  }
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT);
}

}  // namespace snowbough::snow
