#include "snow/dilate.h"

#include <algorithm>

namespace snowbough::snow {
namespace {

float weighted_sum(const WeightedRows& rows, size_t row, const std::vector<float>& values) {
  float sum = 0.0f;
  for (int32_t t = rows.begin[row]; t < rows.begin[row + 1]; ++t) {
    sum += rows.weight[t] * values[rows.source[t]];
  }
  return sum;
}

}  // namespace

void continue_beyond_charts(const TexelTable& table, const SeamTable& seams,
                            std::vector<float>& map) {
  const WeightedRows& rows = seams.dilated_rows;
  for (size_t r = 0; r < rows.size(); ++r) {
    float sum = 0.0f;
    for (int32_t t = rows.begin[r]; t < rows.begin[r + 1]; ++t) {
      sum += rows.weight[t] * map[table.texel[rows.source[t]]];
    }
    map[seams.dilated[r]] = sum;
  }
}

void level_seams(const SeamTable& seams, std::vector<float>& map) {
  const SeamLevelling& levelling = seams.levelling;
  std::vector<float> gaps(levelling.gaps.size());
  for (int32_t round = 0; round < kLevellingRounds; ++round) {
    for (size_t p = 0; p < gaps.size(); ++p) gaps[p] = weighted_sum(levelling.gaps, p, map);
    for (size_t i = 0; i < levelling.texel.size(); ++i) {
      float& height = map[levelling.texel[i]];
      height = std::max(0.0f, height + weighted_sum(levelling.corrections, i, gaps));
    }
  }
}

std::vector<glm::vec3> dilate_normals(const TexelTable& table, const SeamTable& seams,
                                      const std::vector<glm::vec3>& normals) {
  std::vector<glm::vec3> map(static_cast<size_t>(table.resolution) * table.resolution,
                             glm::vec3(0.0f, 0.0f, 1.0f));
  for (size_t i = 0; i < table.texel.size(); ++i) map[table.texel[i]] = normals[i];
  for (size_t r = 0; r < seams.dilated.size(); ++r) {
    map[seams.dilated[r]] = normals[seams.dilated_nearest[r]];
  }
  return map;
}

}  // namespace snowbough::snow
