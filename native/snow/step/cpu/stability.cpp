#include "snow/step/cpu/stability.h"

#include <algorithm>

#include "base/parallel_for.h"
#include "snow/step/cpu/kernel.h"

namespace snowbough::snow {
namespace kernel {
namespace {

/// Texels whose sums are added up as floats.
constexpr size_t kRun = 128;

struct Settle {
#include "shaders/lib/texel_stability.h"

  float* height_map;
  const uint* places;
  size_t texel_count;
};

/// Settles texels [begin, end); returns their sums and sets `holds_snow` where some lies after the
/// step.
SNOWBOUGH_KERNEL vec4 settle_run(Settle settle, size_t begin, size_t end, bool& holds_snow) {
  const Settle::WholeStep whole = settle.whole_step();
  // A row of the map lies in another page: it is asked for some texels before it is needed.
  constexpr size_t kAhead = 64;
  vec4 sums(0.0f);
  float highest = 0.0f;
  for (size_t i = begin; i < end; ++i) {
    if (i + kAhead < settle.texel_count) {
      __builtin_prefetch(&settle.height_map[settle.places[i + kAhead]], 1);
    }
    float& height = settle.height_map[settle.places[i]];
    const uvec4 step = settle.texel_steps[i];
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

void cpu::settle(Scene& scene, const StabilitySettings& settings, float full_gain, float dt) {
  for (Receiver& receiver : scene.receivers) {
    kernel::Settle settle{};
    settle.places = receiver.places.data();
    settle.texel_count = receiver.places.size();
    settle.texel_steps = kernel::rows<glm::uvec4>(receiver.steps);
    settle.height_map = receiver.height.data();
    settle.full_gain = full_gain;
    settle.max_depth = settings.max_depth;
    settle.dt = dt;
    settle.half_life = settings.reckoned_half_life();
    std::vector<glm::dvec4> sums(receiver.active.size(), glm::dvec4(0.0));
    base::for_each_item(receiver.active.size(), 4, [&](size_t i) {
      const size_t group = receiver.active[i];
      const size_t end = receiver.first_texel(group + 1);
      bool holds_snow = false;
      for (size_t run = receiver.first_texel(group); run < end; run += kernel::kRun) {
        sums[i] += glm::dvec4(
            kernel::settle_run(settle, run, std::min(run + kernel::kRun, end), holds_snow));
      }
      receiver.holds_snow[group] = holds_snow ? 1 : 0;
    });
    for (const glm::dvec4& sum : sums) {
      receiver.sums.deposited += sum.x;
      receiver.sums.slid += sum.y;
      receiver.sums.held += sum.z;
      receiver.sums.visible_area += sum.w;
    }
  }
}

}  // namespace snowbough::snow
