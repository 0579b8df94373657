#include "snow/stability.h"

#include "snow/settle_kernel.h"
#include "snow/texel_groups.h"

namespace snowbough::snow {

void StabilityPass::run(SceneBuffers& scene, const StabilitySettings& settings,
                        const PendingShares& pending, const StepSnow& snow, float dt) {
  if (scene.on_processor) {
    for (TexelBatch& batch : scene.batches) {
      settle_on_processor(scene, settings, pending, snow, dt, batch, walkers_);
    }
    return;
  }
  const bool maps = pending.on_deposit_maps;
  const bool has_tile = !maps && pending.weight_sum != nullptr;
  const bool earlier = !maps && (!has_tile || pending.earlier_tiles);
  std::vector<std::string> defines;
  if (maps) {
    defines.emplace_back("DEPOSIT_MAP");
  }
  if (has_tile) {
    defines = snow.defines();
    defines.emplace_back("LAST_TILE");
  }
  if (earlier) {
    defines.emplace_back("EARLIER_TILES");
  }
  defines.push_back(walkers_define(walkers_));
  gpu::Program& program = programs_.with(defines);
  for (TexelBatch& batch : scene.batches) {
    program.use();
    program.bind_texture("groups", batch.views.active_groups);
    program.bind("GroupStates", batch.group_states);
    program.bind_texture("texel_words", batch.views.texel_words);
    program.bind_texture("texel_steps", batch.views.steps);
    if (has_tile) {
      program.bind("Fall", *pending.fall);
      program.bind_texture("weight_sum", *pending.weight_sum_view);
      program.set("tile_size", pending.tile.size());
      if (snow.has_noise) {
        program.set("tile_origin", pending.tile.low);
      }
    }
    if (earlier) {
      program.bind("DepositShare", batch.share);
    }
    const MapGroup& group = scene.groups[static_cast<size_t>(batch.group)];
    if (maps) {
      program.bind_texture("deposit_map", group.deposit);
    } else {
      program.bind("DepositUnits", batch.units);
      program.bind_texture("units_before", batch.views.units);
      program.set("step_depth", snow.depth);
    }
    program.bind("Partials", batch.partials);
    program.bind_image("height_map", group.height, GL_READ_WRITE);
    program.set("max_depth", settings.max_depth);
    program.set("dt", dt);
    program.set("half_life", reckoned_half_life(settings));
    program.dispatch_indirect(batch.active_groups, kWholeGroups);
  }
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT |
                  GL_TEXTURE_FETCH_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT);
}

}  // namespace snowbough::snow
