#include <algorithm>
#include <bit>

#include "base/parallel_for.h"
#include "snow/step/cpu/kernel.h"
#include "snow/step/cpu/passes.h"

namespace snowbough::snow {
namespace kernel {
namespace {

/// Texels whose sums are added as floats.
constexpr size_t kRun = 16;

struct Stability {
#include "shaders/lib/texel_stability.h"

  float* height_map;
  const uint* places;
  size_t texel_count;
  const cpu::TexelSteps* steps;
  /// Out, per texel: volume that slides off; may be null.
  float* slid;

  /// A TexelStep as one vector.
  uvec4 step_of(size_t i) const {
    return {steps->gain[i], std::bit_cast<uint>(steps->area[i]), std::bit_cast<uint>(steps->up[i]),
            std::bit_cast<uint>(steps->back_up[i])};
  }
};

/// The texels of a run, in separate arrays.
struct RunTexels {
  float height[kRun];
  float stable[kRun];
  float deposited[kRun];
  float held[kRun];
  float visible[kRun];
};

/// Computes a run in which all texels hold snow on the positive side only and keep all of it;
/// otherwise returns false.
inline bool keep_run(Stability stability, size_t begin, size_t count, RunTexels& __restrict run) {
  const uint* __restrict gain = stability.steps->gain.data() + begin;
  const float* __restrict area = stability.steps->area.data() + begin;
  const float* __restrict up = stability.steps->up.data() + begin;
  int32_t others = 0;
  for (size_t k = 0; k < count; ++k) {
    const float height = run.height[k];
    const float deposit = stability.positive_deposit(gain[k]);
    others += stability.gains_only_positive(gain[k]) ? 0 : 1;
    others += height >= 0.0f ? 0 : 1;
    others += stability.keeps_all(height, deposit, up[k]) ? 0 : 1;
    run.stable[k] = height + deposit;
    run.deposited[k] = deposit * area[k];
    run.held[k] = run.stable[k] * area[k];
    run.visible[k] = stability.visible_part(deposit) * area[k];
  }
  return others == 0;
}

/// Prefetches a row of the map, which is in another page, some texels ahead.
inline void fetch_ahead(const Stability& stability, size_t begin) {
  constexpr size_t kAhead = 64;
  if (begin + kAhead + kRun > stability.texel_count) return;
  const uint* const places = stability.places + begin + kAhead;
  for (size_t k = 0; k < kRun; ++k) __builtin_prefetch(&stability.height_map[places[k]], 1);
}

/// Stabilises `count` texels from `begin` on, at most kRun; returns their sums and sets
/// `holds_snow` if any holds snow after the step.
inline dvec4 stabilise_run(Stability& stability, const Stability::WholeStep& whole, size_t begin,
                           size_t count, bool& holds_snow) {
  const uint* places = stability.places + begin;
  RunTexels run;
  fetch_ahead(stability, begin);
  for (size_t k = 0; k < count; ++k) run.height[k] = stability.height_map[places[k]];
  dvec4 sums(0.0);
  float highest = 0.0f;
  if (keep_run(stability, begin, count, run)) {
    vec4 kept(0.0f);
    for (size_t k = 0; k < count; ++k) {
      kept += vec4(run.deposited[k], 0.0f, run.held[k], run.visible[k]);
      highest = max(highest, run.stable[k]);
    }
    sums = dvec4(kept);
  } else {
    // In doubles, so that it is exactly what slides off the texels.
    for (size_t k = 0; k < count; ++k) {
      const uvec4 step = stability.step_of(begin + k);
      const Stability::StableTexel stable =
          stability.stabilise_texel(run.height[k], stability.deposit_of(step), step, whole);
      run.stable[k] = stable.height;
      highest = max(highest, abs(stable.height));
      sums += dvec4(stable.sums);
      if (stability.slid != nullptr) stability.slid[begin + k] = stable.sums.y;
    }
  }
  for (size_t k = 0; k < count; ++k) {
    if (run.stable[k] != run.height[k]) stability.height_map[places[k]] = run.stable[k];
  }
  holds_snow = holds_snow || highest > 0.0f;
  return sums;
}

/// The same for any number of texels.
SNOWBOUGH_KERNEL dvec4 stabilise(Stability stability, size_t begin, size_t end, bool& holds_snow) {
  const Stability::WholeStep whole = stability.whole_step();
  dvec4 sums(0.0);
  size_t run = begin;
  // Full runs separately, so that the compiler knows their length.
  for (; run + kRun <= end; run += kRun) {
    sums += stabilise_run(stability, whole, run, kRun, holds_snow);
  }
  if (run < end) sums += stabilise_run(stability, whole, run, end - run, holds_snow);
  return sums;
}

}  // namespace
}  // namespace kernel

void cpu::apply_stability(Scene& scene, const StabilitySettings& settings, float full_gain,
                          float dt, const GroupWork& before) {
  std::vector<kernel::Stability> stabilities;
  std::vector<std::vector<glm::dvec4>> sums;
  for (Receiver& receiver : scene.receivers) {
    kernel::Stability& stability = stabilities.emplace_back();
    stability.places = receiver.places.data();
    stability.texel_count = receiver.places.size();
    stability.steps = &receiver.steps;
    stability.height_map = receiver.height.data();
    stability.full_gain = full_gain;
    stability.max_depth = settings.max_depth;
    stability.least_up = settings.least_up();
    stability.dt = dt;
    stability.half_life = settings.clamped_half_life();
    if (settings.records_slid) receiver.slid.resize(receiver.places.size(), 0.0f);
    stability.slid = settings.records_slid ? receiver.slid.data() : nullptr;
    sums.emplace_back(receiver.active.size(), glm::dvec4(0.0));
  }
  for_active_groups(scene, [&](Receiver& receiver, size_t number) {
    const size_t group = receiver.active[number];
    if (before) before(receiver, group);
    bool holds_snow = false;
    sums[receiver.slot][number] =
        kernel::stabilise(stabilities[receiver.slot], receiver.first_texel(group),
                          receiver.first_texel(group + 1), holds_snow);
    receiver.holds_snow[group] = holds_snow ? 1 : 0;
  });
  for (Receiver& receiver : scene.receivers) {
    for (size_t i = 0; i < receiver.active.size(); ++i) {
      const glm::dvec4& sum = sums[receiver.slot][i];
      if (settings.records_slid && sum.y > 0.0) receiver.slid_groups.push_back(receiver.active[i]);
      receiver.sums.deposited += sum.x;
      receiver.sums.slid += sum.y;
      receiver.sums.held += sum.z;
      receiver.sums.visible_area += sum.w;
    }
  }
}

}  // namespace snowbough::snow
