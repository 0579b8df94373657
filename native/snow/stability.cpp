#include "snow/stability.h"

#include <algorithm>

namespace snowbough::snow {

void StabilityPass::run(SceneBuffers& scene, const StabilitySettings& settings, float step_depth,
                        float dt) {
  for (TexelBatch& batch : scene.batches) {
    program_.use();
    program_.bind("TriangleSurface", scene.triangle_surface);
    program_.bind("Texels", batch.texels);
    program_.bind("TexelSurface", batch.surface);
    program_.bind("DepositShare", batch.share);
    program_.bind("DepositUnits", batch.units);
    program_.bind("Partials", batch.partials);
    program_.bind_image("height_map", scene.groups[static_cast<size_t>(batch.group)].height,
                        GL_READ_WRITE);
    program_.set("step_depth", step_depth);
    program_.set("max_depth", settings.max_depth);
    program_.set("dt", dt);
    program_.set("half_life", std::max(settings.half_life, 1e-6f));
    program_.dispatch(batch.count / static_cast<int32_t>(shared::kTexelGroup));
  }
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT |
                  GL_TEXTURE_FETCH_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT);
}

}  // namespace snowbough::snow
