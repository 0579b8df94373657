#include "snow/deposit_compute.h"

#include "snow/pixels_kernel.h"
#include "snow/texel_groups.h"
#include "snow/weigh_kernel.h"

namespace snowbough::snow {
namespace {

constexpr GLbitfield kBarriers = GL_SHADER_STORAGE_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT;
/// Behind what wrote a list that a dispatch takes its size from.
constexpr GLbitfield kListBarriers =
    kBarriers | GL_COMMAND_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT;
constexpr shared::ListSize kEmptyList{0, 1, 1, 0};

}  // namespace

void DepositComputePass::weigh(SceneBuffers& scene, const gpu::Buffer& fall, const Tile& tile,
                               const OcclusionTarget& occlusion) {
  const glm::ivec2 size = tile.pixels.size();
  const int64_t bytes = int64_t{4} * size.x * size.y;
  if (weight_sum_.bytes() < bytes) {
    weight_sum_ = gpu::Buffer(bytes);
    weight_sum_view_ = gpu::BufferTexture(weight_sum_, GL_R32UI);
  }
  weight_sum_.clear(bytes);
  for (TexelBatch& batch : scene.batches) {
    if (scene.on_processor) {
      weigh_on_processor(scene, fall, tile, occlusion, batch, weight_sum_);
      continue;
    }
    gpu::Program& weigh = weigh_.with({});
    weigh.use();
    weigh.bind("Fall", fall);
    weigh.bind_texture("groups", batch.views.active_groups);
    weigh.bind_texture("triangle_corners", scene.views.triangle_corners);
    weigh.bind_texture("corner_words", scene.views.corner_words);
    weigh.bind_texture("triangle_words", scene.views.triangle_words);
    weigh.bind_texture("triangle_surface", scene.views.triangle_surface);
    weigh.bind_texture("texels", batch.views.texels);
    weigh.bind_texture("group_slots", batch.views.group_slots);
    weigh.bind_texture("fragment_begin", batch.views.fragment_begin);
    weigh.bind_texture("fragments", batch.views.fragments);
    weigh.bind("TexelSteps", batch.steps);
    weigh.bind_texture("occlusion", occlusion.views.visible);
    weigh.bind("WeightSums", weight_sum_);
    weigh.set("tile_origin", tile.pixels.low);
    weigh.set("tile_size", size);
    weigh.dispatch_indirect(batch.active_groups, kBlocks);
  }
  glMemoryBarrier(kBarriers);
}

void DepositComputePass::list_pixels(SceneBuffers& scene, const gpu::Buffer& fall, const Tile& tile,
                                     const OcclusionTarget& occlusion, const MapGroup& group,
                                     const StepSnow& snow) {
  if (scene.on_processor) {
    list_pixels_on_processor(scene, group, fall, tile, occlusion, weight_sum_, pixel_list_size_,
                             pixel_list_);
    return;
  }
  const glm::ivec2 size = tile.pixels.size();
  pixel_list_size_.write(0, sizeof kEmptyList, &kEmptyList);
  std::vector<std::string> defines = snow.defines();
  defines.push_back(walkers_define(walkers_));
  gpu::Program& program = pixels_.with(defines);
  program.use();
  program.bind("Fall", fall);
  if (snow.has_noise) {
    program.set("tile_origin", tile.pixels.low);
  }
  program.bind("Counts", scene.pixel_counts);
  program.bind("PixelListSize", pixel_list_size_);
  program.bind("PixelList", pixel_list_);
  program.bind_texture("occlusion", occlusion.views.visible);
  program.bind_texture("triangle_words", scene.views.triangle_words);
  program.bind_texture("weight_sum", weight_sum_view_);
  program.set("group_objects", glm::uvec2(group.first_slot, group.end_slot));
  program.set("tile_size", size);
  program.dispatch(gpu::group_count(size.x, shared::kRowRun), size.y);
  glMemoryBarrier(kListBarriers);
}

void DepositComputePass::lay(SceneBuffers& scene, const gpu::Buffer& fall, const Tile& tile,
                             const OcclusionTarget& occlusion, float step_depth, TexelBatch& batch,
                             bool counting) {
  const MapGroup& group = scene.groups[static_cast<size_t>(batch.group)];
  lay_.use();
  lay_.bind("Fall", fall);
  lay_.bind("Counts", scene.pixel_counts);
  lay_.bind("PixelListSize", pixel_list_size_);
  lay_.bind("PixelList", pixel_list_);
  spread_list_size_.write(0, sizeof kEmptyList, &kEmptyList);
  lay_.bind("SpreadListSize", spread_list_size_);
  lay_.bind("SpreadList", spread_list_);
  lay_.bind("DepositUnits", batch.units);
  lay_.bind_texture("triangle_corners", scene.views.triangle_corners);
  lay_.bind_texture("triangle_words", scene.views.triangle_words);
  lay_.bind_texture("map_triangles", scene.views.map_triangles);
  lay_.bind_texture("map_offsets", scene.views.map_offsets);
  lay_.bind_texture("texel_steps", batch.views.step_floats);
  lay_.bind_texture("occlusion", occlusion.views.visible);
  lay_.bind_texture("weight_sum", weight_sum_view_);
  lay_.bind_texture("owners", group.owners);
  lay_.set("group_objects", glm::uvec2(group.first_slot, group.end_slot));
  lay_.set("batch_texels", glm::uvec2(batch.first, batch.first + batch.count));
  lay_.set("counting", counting ? 1 : 0);
  lay_.set("tile_origin", tile.pixels.low);
  lay_.set("tile_size", tile.pixels.size());
  lay_.set("step_depth", step_depth);
  lay_.dispatch_indirect(pixel_list_size_);
  glMemoryBarrier(kListBarriers);
}

void DepositComputePass::spread(SceneBuffers& scene, const gpu::Buffer& fall, float step_depth,
                                TexelBatch& batch) {
  spread_.use();
  spread_.bind("Fall", fall);
  spread_.bind("SpreadListSize", spread_list_size_);
  spread_.bind("SpreadList", spread_list_);
  spread_.bind("DepositUnits", batch.units);
  spread_.bind_texture("triangle_surface", scene.views.triangle_surface);
  spread_.bind_texture("texels", batch.views.texels);
  spread_.bind_texture("texel_steps", batch.views.step_floats);
  spread_.bind_texture("owners", scene.groups[static_cast<size_t>(batch.group)].owners);
  spread_.set("batch_texels", glm::uvec2(batch.first, batch.first + batch.count));
  spread_.set("step_depth", step_depth);
  spread_.dispatch_indirect(spread_list_size_);
  glMemoryBarrier(kListBarriers);
}

void DepositComputePass::share_out(SceneBuffers& scene, const gpu::Buffer& fall, const Tile& tile,
                                   const StepSnow& snow) {
  gpu::Program& program = share_.with(snow.defines());
  for (TexelBatch& batch : scene.batches) {
    program.use();
    program.bind("Fall", fall);
    program.bind_texture("groups", batch.views.active_groups);
    program.bind_texture("texel_steps", batch.views.steps);
    program.bind("DepositShare", batch.share);
    program.bind_texture("weight_sum", weight_sum_view_);
    program.set("tile_size", tile.pixels.size());
    if (snow.has_noise) {
      program.set("tile_origin", tile.pixels.low);
    }
    program.dispatch_indirect(batch.active_groups, kBlocks);
  }
  glMemoryBarrier(kBarriers);
}

void DepositComputePass::run(SceneBuffers& scene, const gpu::Buffer& fall, const Tile& tile,
                             const OcclusionTarget& occlusion, const StepSnow& snow, bool is_last) {
  weigh(scene, fall, tile, occlusion);
  const glm::ivec2 size = tile.pixels.size();
  const int64_t pixels = int64_t{size.x} * size.y;
  if (pixel_list_.bytes() < pixels * 4) {
    pixel_list_size_ = gpu::Buffer(sizeof(shared::ListSize));
    pixel_list_ = gpu::Buffer(pixels * 4);
    spread_list_size_ = gpu::Buffer(sizeof(shared::ListSize));
    spread_list_ = gpu::Buffer(pixels * static_cast<int64_t>(sizeof(shared::SpreadSnow)));
  }
  int32_t listed_group = -1;
  for (TexelBatch& batch : scene.batches) {
    const bool is_new = batch.group != listed_group;
    if (is_new) {
      list_pixels(scene, fall, tile, occlusion, scene.groups[static_cast<size_t>(batch.group)],
                  snow);
      listed_group = batch.group;
    }
    lay(scene, fall, tile, occlusion, snow.depth, batch, is_new);
    spread(scene, fall, snow.depth, batch);
  }
  if (!is_last) {
    share_out(scene, fall, tile, snow);
  }
}

}  // namespace snowbough::snow
