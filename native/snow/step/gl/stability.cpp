#include "snow/step/gl/passes.h"

namespace snowbough::snow {

void StabilityPass::run(SceneBuffers& scene, const StabilitySettings& settings, float full_gain,
                        float dt, bool in_metres) {
  std::vector<std::string> defines{local_size_define(local_size_)};
  if (in_metres) defines.emplace_back("GAIN_IN_METRES");
  if (settings.records_slid) defines.emplace_back("RECORD_SLID");
  gpu::Program& program = programs_.with(defines);
  for (TexelBatch& batch : scene.batches) {
    const MapGroup& group = scene.groups[static_cast<size_t>(batch.group)];
    program.use();
    program.bind_texture("groups", batch.views.active_groups);
    program.bind("GroupStates", batch.group_states);
    program.bind_texture("places", batch.views.places);
    program.bind_texture("texel_steps", batch.views.steps);
    program.set("full_gain", full_gain);
    program.bind("Partials", batch.partials);
    if (settings.records_slid) {
      if (batch.slid.id() == 0) batch.slid = gpu::Buffer(int64_t{4} * batch.count);
      batch.slid.clear();
      program.bind("Slid", batch.slid);
    }
    program.bind_image("height_map", group.height, GL_READ_WRITE);
    program.set("max_depth", settings.max_depth);
    program.set("least_up", settings.least_up());
    program.set("dt", dt);
    program.set("half_life", settings.clamped_half_life());
    program.dispatch_indirect(batch.active_groups, kWholeGroups);
  }
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT |
                  GL_TEXTURE_FETCH_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT);
}

}  // namespace snowbough::snow
