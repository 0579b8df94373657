#include "snow/stability.h"

#include <algorithm>

#include "snow/texel_groups.h"

namespace snowbough::snow {

gpu::Program& StabilityPass::program_for(const PendingShares& pending) {
  if (pending.on_deposit_maps) {
    return deposit_map_;
  }
  if (pending.pixel_share == nullptr) {
    return shares_waiting_;
  }
  return pending.earlier_tiles ? all_tiles_ : last_tile_;
}

void StabilityPass::run(SceneBuffers& scene, const StabilitySettings& settings,
                        const PendingShares& pending, float step_depth, float dt) {
  const bool maps = pending.on_deposit_maps;
  const bool has_tile = !maps && pending.pixel_share != nullptr;
  const bool earlier = !maps && (!has_tile || pending.earlier_tiles);
  gpu::Program& program = program_for(pending);
  for (TexelBatch& batch : scene.batches) {
    program.use();
    program.bind_texture("groups", batch.views.active_groups);
    program.bind("GroupStates", batch.group_states);
    program.bind_texture("texel_up", batch.views.up);
    program.bind_texture("texels", batch.views.texels);
    program.bind_texture("texel_surface", batch.views.surface);
    if (has_tile) {
      program.bind_texture("pixel_share", *pending.pixel_share);
      program.bind_texture("targets", batch.views.targets);
    }
    if (earlier) {
      program.bind("DepositShare", batch.share);
    }
    const MapGroup& group = scene.groups[static_cast<size_t>(batch.group)];
    if (maps) {
      program.bind_texture("deposit_map", group.deposit);
    } else {
      program.bind("DepositUnits", batch.units);
      program.set("step_depth", step_depth);
    }
    program.bind("Partials", batch.partials);
    program.bind_image("height_map", group.height, GL_READ_WRITE);
    program.set("max_depth", settings.max_depth);
    program.set("dt", dt);
    program.set("half_life", std::max(settings.half_life, 1e-6f));
    program.dispatch_indirect(batch.active_groups, kWholeGroups);
  }
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT |
                  GL_TEXTURE_FETCH_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT);
}

}  // namespace snowbough::snow
