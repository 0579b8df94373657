#include "snow/settle_kernel.h"

#include "base/parallel_for.h"
#include "snow/processor_kernel.h"

namespace snowbough::snow {
namespace kernel {
namespace {

struct Settle {
#include "shaders/texel_settle.h"

  float* height_map;
  const uint* places;
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
  for (; index < end && settle.places[index] != kNowhere; ++index) {
    if (index + kAhead < settle.texel_count) {
      // kNowhere is an address behind the map, which may be prefetched, too.
      __builtin_prefetch(&settle.height_map[settle.places[index + kAhead]], 1);
    }
    float& height = settle.height_map[settle.places[index]];
    const uvec4 step = settle.texel_steps[index];
    const Settle::SettledTexel settled =
        settle.settle_texel(height, settle.deposit_of(step), step, whole);
    if (settled.height != height) height = settled.height;
    highest = max(highest, settled.height);
    sums += settled.sums;
  }
  holds_snow = holds_snow || highest > 0.0f;
  return sums;
}

}  // namespace
}  // namespace kernel

void settle_on_processor(SceneBuffers& scene, const StabilitySettings& settings, float full_gain,
                         float dt, TexelBatch& batch, int32_t partials) {
  using gpu::BufferMap;
  const BufferMap groups(batch.active_groups);
  const BufferMap states(batch.group_states);
  const BufferMap places(batch.places);
  const BufferMap steps(batch.steps);
  const BufferMap sums(batch.partials);
  const BufferMap heights(scene.groups[static_cast<size_t>(batch.group)].height_rows);
  kernel::Settle settle{};
  settle.places = places.as<uint32_t>();
  settle.texel_count = batch.count;
  settle.texel_steps = steps.as<glm::uvec4>();
  settle.height_map = heights.as<float>();
  settle.full_gain = full_gain;
  settle.max_depth = settings.max_depth;
  settle.dt = dt;
  settle.half_life = reckoned_half_life(settings);
  const auto* list = groups.as<uint32_t>();
  const auto run = static_cast<int32_t>(shared::kTexelGroup) / partials;
  base::for_each_item(list[1], 4, [&](size_t i) {
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
