#include "snow/settle_kernel.h"

#include <optional>

#include "snow/processor_kernel.h"

namespace snowbough::snow {
namespace kernel {
namespace {

#define LAST_TILE
#define EARLIER_TILES
struct Settle {
#include "shaders/texel_settle.h"

  float* height_map;
  const Texel* texels;
  int32_t texel_count;
};

/// Settles texels from `index` to `end` or the object's last; returns their sums and sets
/// `holds_snow` where some lies after the step.
SNOWBOUGH_KERNEL vec4 settle_texels(Settle settle, int32_t index, int32_t end, bool& holds_snow) {
  const Settle::WholeStep whole = settle.whole_step();
  // A row of the map lies in another page: it is asked for some texels before it is needed.
  constexpr int32_t kAhead = 64;
  vec4 sums(0.0f);
  float highest = 0.0f;
  for (; index < end && settle.texels[index].place != kNowhere; ++index) {
    if (index + kAhead < settle.texel_count) {
      // Nobody's place lies behind the map, which does no harm here.
      __builtin_prefetch(&settle.height_map[settle.texels[index + kAhead].place], 1);
      const uint pixel = settle.texel_steps[index + kAhead].x;
      if (settle.weight_sum != nullptr)
        __builtin_prefetch(&settle.weight_sum[settle.pixel_index(settle.unpacked_pixel(pixel))]);
    }
    float& height = settle.height_map[settle.texels[index].place];
    const uvec4 step = settle.texel_steps[index];
    const Settle::SettledTexel settled =
        settle.settle_texel(height, settle.take_deposit(index, step), step, whole);
    if (settled.height != height) height = settled.height;
    highest = max(highest, settled.height);
    sums += settled.sums;
  }
  holds_snow = holds_snow || highest > 0.0f;
  return sums;
}

}  // namespace
}  // namespace kernel

void settle_on_processor(SceneBuffers& scene, const StabilitySettings& settings,
                         const PendingShares& pending, const StepSnow& snow, float dt,
                         TexelBatch& batch, int32_t partials) {
  using gpu::BufferMap;
  const BufferMap groups(batch.active_groups);
  const BufferMap states(batch.group_states);
  const BufferMap texels(batch.texels);
  const BufferMap steps(batch.steps);
  const BufferMap units(batch.units);
  const BufferMap sums(batch.partials);
  const BufferMap heights(scene.groups[static_cast<size_t>(batch.group)].height_rows);
  std::optional<BufferMap> share;
  std::optional<BufferMap> weight_sum;
  kernel::Settle settle{};
  settle.texels = texels.as<shared::Texel>();
  settle.texel_count = batch.count;
  settle.texel_steps = steps.as<glm::uvec4>();
  settle.deposit_units = units.as<uint32_t>();
  settle.units_before = units.as<shared::Word>();
  settle.height_map = heights.as<float>();
  settle.step_depth = snow.depth;
  settle.max_depth = settings.max_depth;
  settle.dt = dt;
  settle.half_life = reckoned_half_life(settings);
  if (pending.weight_sum != nullptr) {
    settle.weight_sum = weight_sum.emplace(*pending.weight_sum).as<shared::Word>();
    pending.fall->read(0, sizeof settle.fall, &settle.fall);
    settle.tile_origin = pending.tile.low;
    settle.tile_size = pending.tile.size();
  }
  if (pending.weight_sum == nullptr || pending.earlier_tiles) {
    settle.deposit_share = share.emplace(batch.share).as<float>();
  }
  const auto* list = groups.as<uint32_t>();
  const auto run = static_cast<int32_t>(shared::kTexelGroup) / partials;
  for_each_in_parallel(static_cast<int32_t>(list[1]), 4, [&](int32_t i) {
    const auto group = static_cast<int32_t>(list[shared::kGroupListBegin + i]);
    bool holds_snow = false;
    for (int32_t part = group * partials; part < (group + 1) * partials; ++part) {
      sums.as<glm::vec4>()[part] =
          kernel::settle_texels(settle, part * run, (part + 1) * run, holds_snow);
    }
    if (holds_snow) states.as<uint32_t>()[group] |= shared::kHoldsSnow;
  });
}

}  // namespace snowbough::snow
