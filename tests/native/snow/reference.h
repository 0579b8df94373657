#pragma once

#include <vector>

#include "snow/output/dilate.h"
#include "snow/output/map_output.h"
#include "snow/output/normals.h"
#include "snow/output/smoothing.h"
#include "snow/seams/seam_leveller.h"
#include "snow/seams/seam_table.h"

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

inline MapOutput output_reference(const TexelTable& table, const SeamTable& seams,
                                  const SmoothingPlan& plan, const std::vector<float>& stored,
                                  const std::vector<SurfaceMetric>& metrics = {}) {
  std::vector<float> values(table.texel.size());
  for (size_t i = 0; i < values.size(); ++i) values[i] = stored[table.texel[i]];
  MapOutput output;
  output.height = dilated(table, seams, smooth_reference(seams, plan, values));
  if (plan.closing_passes > 0) SeamLeveller(seams.levelling).run(output.height);
  if (!metrics.empty()) output.normal = normal_map(table, seams, metrics, output.height);
  return output;
}

}  // namespace snowbough::snow
