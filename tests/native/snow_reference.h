#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "snow/dilate.h"
#include "snow/level_seams.h"
#include "snow/map_output.h"
#include "snow/normals.h"
#include "snow/seam_table.h"
#include "snow/smoothing.h"

// Smoothing in its plainest form: what the fast ones are compared with.
namespace snowbough::snow {

/// Filters `values` along the lines.
inline std::vector<float> filtered(const TexelLines& lines, const std::vector<uint8_t>& level,
                                   const std::vector<float>& values) {
  std::vector<float> line;
  fill_lines(lines, values, line);
  std::vector<float> result(values.size());
  const auto& levels = filter_levels();
  for (size_t i = 0; i < values.size(); ++i) {
    const float* at = line.data() + lines.place[i];
    const FilterWeights& w = levels[level[i]];
    float sum = w[0] * at[0];
    float weight = w[0];
    for (int32_t k = 1; k <= kFilterReach; ++k) {
      for (const float value : {at[-k], at[k]}) {
        const float present = value >= 0.0f ? w[k] : 0.0f;
        sum += present * value;
        weight += present;
      }
    }
    result[i] = sum / weight;
  }
  return result;
}

inline std::vector<float> smooth_reference(const SeamTable& seams, const SmoothingPlan& plan,
                                           const std::vector<float>& height) {
  std::vector<float> values = height;
  for (int32_t pass = 0; pass < plan.passes; ++pass) {
    values = filtered(seams.u, plan.level_u, values);
    values = filtered(seams.v, plan.level_v, values);
  }
  for (int32_t pass = 0; pass < plan.closing_passes; ++pass) {
    const std::vector<float> along_v = filtered(seams.v, plan.level_v, values);
    values = filtered(seams.u, plan.level_u, values);
    for (size_t i = 0; i < values.size(); ++i) values[i] = 0.5f * (values[i] + along_v[i]);
  }
  return values;
}

/// One value an owned texel, put on the map and continued beyond the charts.
inline std::vector<float> dilated(const TexelTable& table, const SeamTable& seams,
                                  const std::vector<float>& values) {
  std::vector<float> map(static_cast<size_t>(table.resolution) * table.resolution, 0.0f);
  for (size_t i = 0; i < values.size(); ++i) map[table.texel[i]] = values[i];
  const WeightedRows& rows = seams.dilated_rows;
  for (size_t r = 0; r < rows.size(); ++r) {
    for (int32_t t = rows.begin[r]; t < rows.begin[r + 1]; ++t) {
      map[seams.dilated[r]] += rows.weight[t] * values[rows.source[t]];
    }
  }
  return map;
}

/// Half of what the second side shows less what the first side shows, and the height there.
inline std::pair<float, float> seam_gap(const WeightedRows& gaps, size_t point,
                                        const std::vector<float>& map) {
  float half_gap = 0.0f;
  float height = 0.0f;
  for (int32_t t = gaps.begin[point]; t < gaps.begin[point + 1]; ++t) {
    half_gap += gaps.weight[t] * map[gaps.source[t]];
    height += std::abs(gaps.weight[t]) * map[gaps.source[t]];
  }
  return {half_gap, height};
}

/// One round over all points; `share` says how much of each point's difference counts.
inline void level_round(const SeamLevelling& levelling, const std::vector<float>& share,
                        float momentum, std::vector<float>& map, std::vector<float>& ahead,
                        const std::vector<float>* start = nullptr) {
  std::vector<float> gaps(levelling.gaps.size());
  for (size_t p = 0; p < gaps.size(); ++p) {
    gaps[p] = share[p] * seam_gap(levelling.gaps, p, ahead).first;
  }
  for (size_t i = 0; i < levelling.texel.size(); ++i) {
    const WeightedRows& rows = levelling.corrections;
    float sum = 0.0f;
    for (int32_t t = rows.begin[i]; t < rows.begin[i + 1]; ++t) {
      sum += rows.weight[t] * gaps[rows.source[t]];
    }
    const int32_t texel = levelling.texel[i];
    float next = std::max(0.0f, ahead[texel] + sum);
    if (start != nullptr) {
      const float reach = kMostChange * ((*start)[texel] + levelling.least_height);
      next = std::clamp(next, std::max(0.0f, (*start)[texel] - reach), (*start)[texel] + reach);
    }
    ahead[texel] = std::max(0.0f, next + momentum * (next - map[texel]));
    map[texel] = next;
  }
}

inline void level_seams(const SeamTable& seams, std::vector<float>& map) {
  const SeamLevelling& levelling = seams.levelling;
  std::vector<float> share(levelling.gaps.size(), 1.0f);
  std::vector<float> ahead = map;
  level_round(levelling, share, 0.0f, map, ahead);
  for (size_t p = 0; p < share.size(); ++p) {
    const auto [half_gap, height] = seam_gap(levelling.gaps, p, map);
    const float allowed = kLevelWithin * std::max(height, levelling.least_height);
    share[p] = std::clamp(2.0f * std::abs(half_gap) / allowed - 1.0f, 0.0f, 1.0f);
  }
  // A point has the largest share of those that a texel of its own also serves.
  std::vector<float> texel_share(map.size(), 0.0f);
  for (size_t i = 0; i < levelling.texel.size(); ++i) {
    const WeightedRows& rows = levelling.corrections;
    for (int32_t t = rows.begin[i]; t < rows.begin[i + 1]; ++t) {
      float& most = texel_share[levelling.texel[i]];
      most = std::max(most, share[rows.source[t]]);
    }
  }
  for (size_t p = 0; p < share.size(); ++p) {
    share[p] = 0.0f;
    for (int32_t t = levelling.gaps.begin[p]; t < levelling.gaps.begin[p + 1]; ++t) {
      share[p] = std::max(share[p], texel_share[levelling.gaps.source[t]]);
    }
  }
  const std::vector<float> start = map;
  for (int32_t k = 0; k < kFineRounds; ++k) {
    level_round(levelling, share, fine_momentum(k), map, ahead, &start);
  }
}

inline MapOutput output_reference(const TexelTable& table, const SeamTable& seams,
                                  const SmoothingPlan& plan, const std::vector<float>& stored,
                                  const std::vector<SurfaceMetric>& metrics = {}) {
  std::vector<float> values(table.texel.size());
  for (size_t i = 0; i < values.size(); ++i) values[i] = stored[table.texel[i]];
  MapOutput output;
  output.height = dilated(table, seams, smooth_reference(seams, plan, values));
  if (plan.closing_passes > 0) level_seams(seams, output.height);
  if (!metrics.empty()) {
    for (size_t i = 0; i < values.size(); ++i) values[i] = output.height[table.texel[i]];
    output.normal = dilate_normals(table, seams, normals_on_cpu(table, seams, metrics, values));
  }
  return output;
}

}  // namespace snowbough::snow
