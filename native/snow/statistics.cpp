#include "snow/statistics.h"

namespace snowbough::snow {
namespace {

void add(SnowBalance& sum, const SnowBalance& other) {
  sum.deposited_volume += other.deposited_volume;
  sum.slid_volume += other.slid_volume;
  sum.held_volume += other.held_volume;
  sum.stretched_volume += other.stretched_volume;
  sum.visible_area += other.visible_area;
  sum.back_face_area += other.back_face_area;
}

}  // namespace

StatisticsPair balance_of(const shared::ObjectSums& sums) {
  StatisticsPair pair;
  SnowBalance& step = pair.step;
  step.deposited_volume = sums.deposited;
  step.slid_volume = sums.slid;
  step.held_volume = sums.held;
  step.stretched_volume = sums.held - (sums.held_before + sums.deposited - sums.slid);
  step.visible_area = sums.visible_area;
  step.back_face_area = sums.back_face_area;

  SnowBalance& total = pair.total;
  total.deposited_volume = sums.total_deposited;
  total.slid_volume = sums.total_slid;
  total.held_volume = sums.held;
  total.stretched_volume = sums.total_stretched;
  total.visible_area = sums.total_visible_area;
  // Back faces have no total of their own: what counts is whether they show now.
  total.back_face_area = step.back_face_area;
  return pair;
}

void add_balance(StatisticsPair& sum, const StatisticsPair& other) {
  add(sum.step, other.step);
  add(sum.total, other.total);
}

void StatisticsPass::open(SceneBuffers& scene) {
  open_.use();
  open_.bind("Sums", scene.sums);
  open_.bind("BackPixels", scene.back_pixels);
  open_.set("object_count", static_cast<uint32_t>(scene.slot.size()));
  open_.dispatch(gpu::group_count(static_cast<int64_t>(scene.slot.size()), 64));
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
  close_.set("object_count", static_cast<uint32_t>(scene.slot.size()));
  close_.set("pixel_area", pixel_area);
  close_.dispatch(gpu::group_count(static_cast<int64_t>(scene.slot.size()), 64));
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
}

}  // namespace snowbough::snow
