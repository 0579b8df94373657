#include "snow/output/dilate.h"

namespace snowbough::snow {

void dilate_heights(const TexelTable& table, const SeamTable& seams, std::vector<float>& map) {
  const WeightedRows& rows = seams.dilated_rows;
  for (size_t r = 0; r < rows.size(); ++r) {
    float sum = 0.0f;
    for (int32_t t = rows.begin[r]; t < rows.begin[r + 1]; ++t) {
      sum += rows.weight[t] * map[table.texel[rows.source[t]]];
    }
    map[seams.dilated[r]] = sum;
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
