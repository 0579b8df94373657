#include <algorithm>

#include "base/parallel_for.h"
#include "snow/step/cpu/kernel.h"
#include "snow/step/cpu/passes.h"

namespace snowbough::snow {
namespace kernel {
namespace {

/// Texels whose sums are added up as floats.
constexpr size_t kRun = 16;

struct Stability {
#include "shaders/lib/texel_stability.h"

  float* height_map;
  const uint* places;
  size_t texel_count;
};

/// Stabilises texels [begin, end); returns their sums and sets `holds_snow` where some lies after
/// the step.
SNOWBOUGH_KERNEL vec4 stabilise_run(Stability stability, size_t begin, size_t end,
                                    bool& holds_snow) {
  const Stability::WholeStep whole = stability.whole_step();
  // A row of the map lies in another page: it is asked for some texels before it is needed.
  constexpr size_t kAhead = 64;
  vec4 sums(0.0f);
  float highest = 0.0f;
  for (size_t i = begin; i < end; ++i) {
    if (i + kAhead < stability.texel_count) {
      __builtin_prefetch(&stability.height_map[stability.places[i + kAhead]], 1);
    }
    float& height = stability.height_map[stability.places[i]];
    const uvec4 step = stability.texel_steps[i];
    const Stability::StableTexel stable =
        stability.stabilise_texel(height, stability.deposit_of(step), step, whole);
    if (stable.height != height) height = stable.height;
    highest = max(highest, abs(stable.height));
    sums += stable.sums;
  }
  holds_snow = holds_snow || highest > 0.0f;
  return sums;
}

}  // namespace
}  // namespace kernel

void cpu::apply_stability(Scene& scene, const StabilitySettings& settings, float full_gain,
                          float dt) {
  for (Receiver& receiver : scene.receivers) {
    kernel::Stability stability{};
    stability.places = receiver.places.data();
    stability.texel_count = receiver.places.size();
    stability.texel_steps = kernel::rows<glm::uvec4>(receiver.steps);
    stability.height_map = receiver.height.data();
    stability.full_gain = full_gain;
    stability.max_depth = settings.max_depth;
    stability.dt = dt;
    stability.half_life = settings.reckoned_half_life();
    std::vector<glm::dvec4> sums(receiver.active.size(), glm::dvec4(0.0));
    base::for_each_item(receiver.active.size(), 4, [&](size_t i) {
      const size_t group = receiver.active[i];
      const size_t end = receiver.first_texel(group + 1);
      bool holds_snow = false;
      for (size_t run = receiver.first_texel(group); run < end; run += kernel::kRun) {
        sums[i] += glm::dvec4(
            kernel::stabilise_run(stability, run, std::min(run + kernel::kRun, end), holds_snow));
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
