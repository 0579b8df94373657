#include <algorithm>
#include <array>
#include <cstring>

#include "base/parallel_for.h"
#include "snow/step/cpu/kernel.h"
#include "snow/step/cpu/passes.h"

namespace snowbough::snow {
namespace kernel {
namespace {

#define WITH_SHADING
struct Surface {
#include "shaders/lib/texel_surface.h"
};

/// Surface::FragmentSums of a group's texels: area, up and upper in one vector, so that a fragment
/// is added at once; and back_up and back_upper, only used with two-sided triangles.
struct GroupSums {
  alignas(16) std::array<std::array<float, 4>, kTexelGroup> positive;
  alignas(16) std::array<std::array<float, 4>, kTexelGroup> back;
  bool has_back = false;
};

inline void add(std::array<float, 4>& sum, const base::Float4& part, float area) {
  base::Float4 all;
  std::memcpy(&all, sum.data(), sizeof all);
  all += part * area;
  std::memcpy(sum.data(), &all, sizeof all);
}

/// Contribution of a fragment of area 1 to the positive side and the back: Surface::with_fragment.
inline base::Float4 positive_of(float up) {
  return base::Float4{1.0f, up, max(up, 0.0f), 0.0f};
}
inline base::Float4 back_of(float up) {
  return base::Float4{-up, max(-up, 0.0f), 0.0f, 0.0f};
}

/// Adds a run's fragments to their texels' sums; stores their areas in `part`.
inline void add_run(Surface& surface, const cpu::FragmentRuns& all, uint32_t begin, uint32_t end,
                    uint32_t triangle, float* __restrict part, GroupSums& sums) {
  const vec4 own = texelFetch(surface.triangle_surface, static_cast<int>(triangle));
  const bool two_sided = own.w != 0.0f;
  const float* __restrict share = all.share.data();
  const uint16_t* __restrict texel = all.texel.data();
  for (size_t f = begin; f < end; ++f) part[f] = share[f] * own.y;
  if (!surface.is_smooth(triangle)) {
    const base::Float4 positive = positive_of(own.z);
    for (size_t f = begin; f < end; ++f) add(sums.positive[texel[f]], positive, part[f]);
    const base::Float4 back = back_of(own.z);
    for (size_t f = begin; two_sided && f < end; ++f) add(sums.back[texel[f]], back, part[f]);
    return;
  }
  const Surface::SmoothTriangle points = surface.smooth_triangle(triangle);
  for (size_t f = begin; f < end; ++f) {
    const float up = surface.between(points.corner.z, points.edge_b.z, points.edge_c.z,
                                     all.weight_b[f], all.weight_c[f]);
    add(sums.positive[texel[f]], positive_of(up), part[f]);
    if (two_sided) add(sums.back[texel[f]], back_of(up), part[f]);
  }
}

/// Divisors for areas that may be 0: the dividend is 0 there, too. Separate from the division loop,
/// which would otherwise not vectorise.
inline void find_divisors(const float* __restrict area, size_t count, float* __restrict divisor) {
  for (size_t i = 0; i < count; ++i) divisor[i] = area[i] > 0.0f ? area[i] : 1.0f;
}

/// Upward parts of texels from their sums: Surface::surface_of_sums. `up` and `upper`: positions in
/// the sums.
template <size_t up, size_t upper>
inline void find_up(const std::array<float, 4>* __restrict sums, const float* __restrict divisor,
                    size_t count, float* __restrict found) {
  for (size_t i = 0; i < count; ++i) {
    const float all = sums[i][up];
    const float facing_up = sums[i][upper];
    found[i] = facing_up > 0.0f ? facing_up : all;
  }
  for (size_t i = 0; i < count; ++i) found[i] /= divisor[i];
}

/// Divides fragments' areas by their texels' areas.
inline void find_parts(const cpu::FragmentRuns& all, uint32_t begin, uint32_t end,
                       const float* __restrict divisor, float* __restrict part) {
  if (!all.opacity.empty()) {
    const float* __restrict opacity = all.opacity.data();
    for (size_t f = begin; f < end; ++f) part[f] *= opacity[f];
  }
  constexpr size_t kBlock = 64;
  std::array<float, kBlock> whole;
  for (size_t f = begin; f < end; f += kBlock) {
    const size_t count = std::min(kBlock, end - f);
    const uint16_t* __restrict texel = all.texel.data() + f;
    float* __restrict own = part + f;
    for (size_t k = 0; k < count; ++k) whole[k] = divisor[texel[k]];
    for (size_t k = 0; k < count; ++k) own[k] /= whole[k];
  }
}

SNOWBOUGH_KERNEL void evaluate(Surface surface, cpu::FragmentRuns& all, size_t group,
                               size_t first_texel, size_t texel_count, cpu::TexelSteps& steps) {
  const cpu::FragmentRuns::Run* begin = all.runs.data() + all.group_begin[group];
  const cpu::FragmentRuns::Run* end = all.runs.data() + all.group_begin[group + 1];
  GroupSums sums;
  std::fill_n(sums.positive.begin(), texel_count, std::array<float, 4>{});
  for (const cpu::FragmentRuns::Run* run = begin; run < end; ++run) {
    sums.has_back = sums.has_back || surface.triangle_surface[run->triangle].w != 0.0f;
  }
  if (sums.has_back) std::fill_n(sums.back.begin(), texel_count, std::array<float, 4>{});
  for (const cpu::FragmentRuns::Run* run = begin; run < end; ++run) {
    add_run(surface, all, run->begin, run[1].begin, run->triangle, all.part.data(), sums);
  }
  float* const area = steps.area.data() + first_texel;
  for (size_t i = 0; i < texel_count; ++i) area[i] = sums.positive[i][0];
  std::array<float, kTexelGroup> divisor;
  find_divisors(area, texel_count, divisor.data());
  find_up<1, 2>(sums.positive.data(), divisor.data(), texel_count, steps.up.data() + first_texel);
  float* const back_up = steps.back_up.data() + first_texel;
  if (sums.has_back) {
    find_up<0, 1>(sums.back.data(), divisor.data(), texel_count, back_up);
  } else {
    std::fill_n(back_up, texel_count, 0.0f);
  }
  find_parts(all, begin->begin, end->begin, divisor.data(), all.part.data());
}

}  // namespace
}  // namespace kernel

void cpu::evaluate_group(const Scene& scene, Receiver& receiver, size_t group) {
  if (receiver.evaluated_in[group] == receiver.pose) return;
  receiver.evaluated_in[group] = receiver.pose;
  kernel::Surface surface{};
  surface.triangle_surface = scene.surface.data();
  if (scene.layout.smooth_points.count() > 0) {
    surface.triangle_points = scene.layout.smooth_points.of_triangle.data();
    surface.smooth_points = scene.smooth_points.data();
  }
  const size_t first = receiver.first_texel(group);
  kernel::evaluate(surface, receiver.fragments, group, first,
                   receiver.first_texel(group + 1) - first, receiver.steps);
}

void cpu::evaluate_texels(Scene& scene) {
  for_active_groups(scene, [&](Receiver& receiver, size_t number) {
    const size_t group = receiver.active[number];
    evaluate_group(scene, receiver, group);
    const auto gain = receiver.steps.gain.begin();
    std::fill(gain + static_cast<ptrdiff_t>(receiver.first_texel(group)),
              gain + static_cast<ptrdiff_t>(receiver.first_texel(group + 1)), 0u);
  });
}

}  // namespace snowbough::snow
