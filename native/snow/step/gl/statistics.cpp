#include "snow/step/gl/passes.h"

namespace snowbough::snow {

void StatisticsPass::open(SceneBuffers& scene) {
  open_.use();
  open_.bind("Sums", scene.sums);
  open_.bind("BackPixels", scene.back_pixels);
  open_.set("object_count", static_cast<uint32_t>(scene.layout.plan.slot.size()));
  open_.dispatch(gpu::group_count(static_cast<int64_t>(scene.layout.plan.slot.size()), 64));
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

void StatisticsPass::close(SceneBuffers& scene, float pixel_area) {
  for (const TexelBatch& batch : scene.batches) {
    sums_.use();
    sums_.bind("Partials", batch.partials);
    sums_.bind("Segments", batch.segment_buffer);
    sums_.bind("Sums", scene.sums);
    sums_.dispatch(static_cast<int32_t>(batch.segments.size()));
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  }
  close_.use();
  close_.bind("Sums", scene.sums);
  close_.bind("BackPixels", scene.back_pixels);
  close_.set("object_count", static_cast<uint32_t>(scene.layout.plan.slot.size()));
  close_.set("pixel_area", pixel_area);
  close_.dispatch(gpu::group_count(static_cast<int64_t>(scene.layout.plan.slot.size()), 64));
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
}

}  // namespace snowbough::snow
