#pragma once

#include <vector>

#include "snow/output/smoothing.h"
#include "snow/seams/seam_table.h"

// Simple reference implementations of the output's stages.
namespace snowbough::snow {

/// One value an owned texel, smoothed as output is.
inline std::vector<float> smoothed(const TexelTable& table, const SeamTable& seams, float radius,
                                   const std::vector<float>& values) {
  std::vector<float> map(static_cast<size_t>(table.resolution) * table.resolution, 0.0f);
  for (size_t i = 0; i < values.size(); ++i) map[table.texel[i]] = values[i];
  const SmoothingGrid grid = build_smoothing_grid(table, seams);
  Smoother(grid, {radius}, 1).run(map);
  std::vector<float> result;
  for (const int32_t texel : table.texel) result.push_back(map[texel]);
  return result;
}

/// One value an owned texel, put on the map and continued beyond the charts.
inline std::vector<float> dilated(const TexelTable& table, const SeamTable& seams,
                                  const std::vector<float>& values) {
  std::vector<float> map(static_cast<size_t>(table.resolution) * table.resolution, 0.0f);
  for (size_t i = 0; i < values.size(); ++i) map[table.texel[i]] = values[i];
  for (size_t r = 0; r < seams.dilated_rows.size(); ++r) {
    map[seams.dilated[r]] = seams.dilated_rows.sum(r, values);
  }
  return map;
}

}  // namespace snowbough::snow
