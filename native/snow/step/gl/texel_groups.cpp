#include <vector>

#include "snow/step/gl/passes.h"

namespace snowbough::snow {

void TexelGroupsPass::run(SceneBuffers& scene, bool all) {
  const shared::GroupListHeader none{{shared::kBlocksAGroup, 0, 1, 0}, {1, 0, 1, 0}};
  for (TexelBatch& batch : scene.batches) {
    batch.active_groups.write(0, sizeof none, &none);
    // Inactive groups add nothing.
    batch.partials.clear();
    groups_.use();
    groups_.bind_texture("triangle_surface", scene.views.triangle_surface);
    groups_.bind_texture("group_begin", batch.views.group_begin);
    groups_.bind_texture("group_triangles", batch.views.group_triangles);
    groups_.bind("GroupStates", batch.group_states);
    groups_.bind("ActiveGroups", batch.active_groups);
    groups_.set("group_count", static_cast<uint32_t>(batch.group_count()));
    groups_.set("all_groups", all ? 1 : 0);
    groups_.dispatch(gpu::group_count(batch.group_count(), 64));
  }
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT |
                  GL_COMMAND_BARRIER_BIT);
}

void TexelGroupsPass::find_snow(SceneBuffers& scene) {
  for (const TexelBatch& batch : scene.batches) {
    snow_.use();
    snow_.bind_image("height_map", scene.groups[static_cast<size_t>(batch.group)].height,
                     GL_READ_ONLY);
    snow_.bind_texture("places", batch.views.places);
    snow_.set("texel_count", batch.count);
    snow_.bind("GroupStates", batch.group_states);
    snow_.dispatch_items(batch.count, 64);
  }
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

void TexelGroupsPass::forget(SceneBuffers& scene) {
  for (TexelBatch& batch : scene.batches) {
    const std::vector<uint32_t> states(static_cast<size_t>(batch.group_count()),
                                       shared::kHoldsSnow);
    batch.group_states.write(0, static_cast<int64_t>(states.size()) * 4, states.data());
  }
}

}  // namespace snowbough::snow
