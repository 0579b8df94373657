#include "snow/cpu_output.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <thread>

#include "snow/dilate.h"
#include "snow/normals.h"

// Two builds of the inner loops, chosen at run time; without fused multiply-add both give the same
// bits.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__)
#define SNOWBOUGH_WIDE __attribute__((target_clones("avx2", "default")))
#else
#define SNOWBOUGH_WIDE
#endif

namespace snowbough::snow {
namespace {

/// Runs `work(part, parts)` for every part, one a thread.
template <typename Work>
void in_parallel(int32_t threads, const Work& work) {
  const auto parts = static_cast<size_t>(threads);
  std::vector<std::jthread> others;
  for (size_t part = 1; part < parts; ++part) {
    others.emplace_back([&work, part, parts] { work(part, parts); });
  }
  work(size_t{0}, parts);
}

inline float positive(float x) {
  return x > 0.0f ? x : 0.0f;
}

/// Filters `count` texels from `from` on, neighbours `stride` apart. The weights follow from the
/// scale of the two outer taps, each shared by the two texels beside it (see smoothing.h).
template <bool kAdd>
[[gnu::always_inline]] inline void filter_row(const float* __restrict from, float* __restrict to,
                                              const float* __restrict scale, int32_t count,
                                              ptrdiff_t stride) {
  constexpr float kInnerOffset = 1.3846f;
  constexpr float kOuterOffset = 3.2307f;
  constexpr float kInnerWeight = static_cast<float>(0.3162 / 0.9998);
  constexpr float kOuterWeight = static_cast<float>(0.0702 / 0.9998);
  for (int32_t i = 0; i < count; ++i) {
    const float inner = kInnerOffset * scale[i];
    const float outer = kOuterOffset * scale[i];
    const float w1 = kInnerWeight * positive(1.0f - std::fabs(1.0f - inner)) +
                     kOuterWeight * positive(1.0f - std::fabs(1.0f - outer));
    const float w2 = kInnerWeight * positive(1.0f - std::fabs(2.0f - inner)) +
                     kOuterWeight * positive(1.0f - std::fabs(2.0f - outer));
    const float w3 = kOuterWeight * positive(1.0f - std::fabs(3.0f - outer));
    const float w4 = kOuterWeight * positive(1.0f - std::fabs(4.0f - outer));
    const float w0 = 1.0f - 2.0f * (w1 + w2 + w3 + w4);
    const float* at = from + i;
    const float sum =
        w0 * at[0] + w1 * (at[-stride] + at[stride]) + w2 * (at[-2 * stride] + at[2 * stride]) +
        w3 * (at[-3 * stride] + at[3 * stride]) + w4 * (at[-4 * stride] + at[4 * stride]);
    to[i] = kAdd ? 0.5f * (to[i] + sum) : sum;
  }
}

SNOWBOUGH_WIDE void replace_segment(const float* __restrict from, float* __restrict to,
                                    const float* __restrict scale, int32_t count,
                                    ptrdiff_t stride) {
  filter_row<false>(from, to, scale, count, stride);
}

SNOWBOUGH_WIDE void add_segment(const float* __restrict from, float* __restrict to,
                                const float* __restrict scale, int32_t count, ptrdiff_t stride) {
  filter_row<true>(from, to, scale, count, stride);
}

}  // namespace

CpuOutput::CpuOutput(const TexelTable& table, const SeamTable& seams, const SmoothingPlan& plan,
                     int32_t threads)
    : table_(table),
      seams_(seams),
      passes_(plan.passes),
      closing_passes_(plan.closing_passes),
      threads_(std::max(1, threads)),
      leveller_(closing_passes_ > 0 ? seams.levelling : SeamLevelling()) {
  if (closing_passes_ == 0) return;
  prepare(u_, seams.u, 1, plan.level_u);
  prepare(v_, seams.v, table.resolution, plan.level_v);
  const size_t texels = static_cast<size_t>(table.resolution) * table.resolution;
  const size_t ghosts = std::max(seams.u.ghost_place.size(), seams.v.ghost_place.size());
  heights_.assign(texels + ghosts, 0.0f);
  next_.assign(texels + ghosts, 0.0f);
}

void CpuOutput::prepare(Axis& axis, const TexelLines& lines, int32_t stride,
                        const std::vector<uint8_t>& level) {
  const auto texels = static_cast<int32_t>(table_.resolution) * table_.resolution;
  axis.lines = &lines;
  axis.stride = stride;
  axis.scale.assign(static_cast<size_t>(texels), 0.0f);
  for (size_t i = 0; i < level.size(); ++i) axis.scale[table_.texel[i]] = filter_scale(level[i]);

  // Per place of the line array: where its value is found.
  std::vector<int32_t> found(static_cast<size_t>(lines.length), -1);
  for (size_t i = 0; i < table_.texel.size(); ++i) found[lines.place[i]] = table_.texel[i];
  for (size_t g = 0; g < lines.ghost_place.size(); ++g) {
    found[lines.ghost_place[g]] = texels + static_cast<int32_t>(g);
  }
  for (size_t i = 0; i < table_.texel.size(); ++i) {
    const int32_t texel = table_.texel[i];
    std::array<int32_t, 2 * kFilterReach> taps;
    bool plain = true;
    for (int32_t k = 1; k <= kFilterReach; ++k) {
      taps[kFilterReach - k] = found[lines.place[i] - k];
      taps[kFilterReach + k - 1] = found[lines.place[i] + k];
      plain = plain && taps[kFilterReach - k] == texel - k * stride &&
              taps[kFilterReach + k - 1] == texel + k * stride;
    }
    if (!plain) {
      axis.odd_texel.push_back(texel);
      axis.odd_taps.push_back(taps);
      axis.odd_level.push_back(level[i]);
    } else if (!axis.segments.empty() && texel % table_.resolution != 0 &&
               axis.segments.back().first_texel + axis.segments.back().count == texel) {
      ++axis.segments.back().count;
    } else {
      axis.segments.push_back({texel, 1});
    }
  }
}

void CpuOutput::fill_ghosts(const Axis& axis, std::vector<float>& heights) const {
  const size_t texels = static_cast<size_t>(table_.resolution) * table_.resolution;
  const WeightedRows& rows = axis.lines->ghosts;
  // Few ghosts are done sooner than threads are made.
  in_parallel(rows.size() < 20000 ? 1 : threads_, [&](size_t part, size_t parts) {
    const size_t end = rows.size() * (part + 1) / parts;
    for (size_t g = rows.size() * part / parts; g < end; ++g) {
      float sum = 0.0f;
      for (int32_t t = rows.begin[g]; t < rows.begin[g + 1]; ++t) {
        sum += rows.weight[t] * heights[table_.texel[rows.source[t]]];
      }
      heights[texels + g] = rows.begin[g] == rows.begin[g + 1] ? kNothing : sum;
    }
  });
}

void CpuOutput::filter(const Axis& axis, std::vector<float>& from, std::vector<float>& to,
                       bool add) const {
  fill_ghosts(axis, from);
  const auto work_segments = [&](size_t begin, size_t end) {
    for (size_t s = begin; s < end; ++s) {
      const Segment& segment = axis.segments[s];
      const float* source = from.data() + segment.first_texel;
      float* target = to.data() + segment.first_texel;
      const float* scale = axis.scale.data() + segment.first_texel;
      (add ? add_segment : replace_segment)(source, target, scale, segment.count, axis.stride);
    }
  };
  const auto work_odd = [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const int32_t texel = axis.odd_texel[i];
      const std::array<int32_t, 2 * kFilterReach>& taps = axis.odd_taps[i];
      const FilterWeights& w = filter_levels()[axis.odd_level[i]];
      float sum = w[0] * from[texel];
      float present = w[0];
      for (int32_t k = 1; k <= kFilterReach; ++k) {
        for (const int32_t tap : {taps[kFilterReach - k], taps[kFilterReach + k - 1]}) {
          const float value = from[tap];
          const float weight = value >= 0.0f ? w[k] : 0.0f;
          sum += weight * value;
          present += weight;
        }
      }
      to[texel] = add ? 0.5f * (to[texel] + sum / present) : sum / present;
    }
  };
  in_parallel(threads_, [&](size_t part, size_t parts) {
    const auto share = [&](size_t count, size_t t) { return count * t / parts; };
    work_segments(share(axis.segments.size(), part), share(axis.segments.size(), part + 1));
    work_odd(share(axis.odd_texel.size(), part), share(axis.odd_texel.size(), part + 1));
  });
}

MapOutput CpuOutput::run(const std::vector<float>& stored,
                         const std::vector<SurfaceMetric>& metrics) {
  MapOutput output;
  const size_t texels = static_cast<size_t>(table_.resolution) * table_.resolution;
  if (closing_passes_ > 0) {
    std::copy(stored.begin(), stored.end(), heights_.begin());
    for (int32_t pass = 0; pass < passes_; ++pass) {
      filter(u_, heights_, next_, false);
      filter(v_, next_, heights_, false);
    }
    for (int32_t pass = 0; pass < closing_passes_; ++pass) {
      filter(u_, heights_, next_, false);
      filter(v_, heights_, next_, true);
      std::swap(heights_, next_);
    }
    output.height.assign(heights_.begin(), heights_.begin() + static_cast<ptrdiff_t>(texels));
  } else {
    output.height = stored;
  }
  continue_beyond_charts(table_, seams_, output.height);
  if (closing_passes_ > 0) leveller_.run(output.height);
  if (!metrics.empty()) {
    std::vector<float> owned(table_.texel.size());
    for (size_t i = 0; i < owned.size(); ++i) owned[i] = output.height[table_.texel[i]];
    output.normal = dilate_normals(table_, seams_, normals_on_cpu(table_, seams_, metrics, owned));
  }
  return output;
}

}  // namespace snowbough::snow
