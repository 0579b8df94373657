#include "snow/output/normals.h"

#include <cmath>
#include <glm/geometric.hpp>

#include "snow/output/dilate.h"

namespace snowbough::snow {
namespace {

/// Height difference per texel along a line, for every owned texel.
std::vector<float> differences(const TexelLines& lines, const std::vector<float>& height) {
  std::vector<float> line(static_cast<size_t>(lines.length), kNothing);
  fill_lines(lines, height, line);
  std::vector<float> result(height.size());
  for (size_t i = 0; i < height.size(); ++i) {
    const float* at = line.data() + lines.place[i];
    const bool before = at[-1] > kSomething;
    const bool after = at[1] > kSomething;
    const float span = (before ? 1.0f : 0.0f) + (after ? 1.0f : 0.0f);
    result[i] = span == 0.0f ? 0.0f : ((after ? at[1] : at[0]) - (before ? at[-1] : at[0])) / span;
  }
  return result;
}

glm::vec3 tangent_normal(const SurfaceMetric& metric, float along_u, float along_v) {
  const float tangent = std::sqrt(metric.uu);
  if (!(tangent > 0.0f)) return {0.0f, 0.0f, 1.0f};
  // dP/dv = (sheared, across) in the basis of unit tangent and bitangent.
  const float sheared = metric.uv / tangent;
  const float across_squared = metric.vv - sheared * sheared;
  if (!(across_squared > 0.0f)) return {0.0f, 0.0f, 1.0f};
  const float slope_t = along_u / tangent;
  const float slope_b = (along_v - slope_t * sheared) / std::sqrt(across_squared);
  return glm::normalize(glm::vec3(-slope_t, -slope_b, 1.0f));
}

}  // namespace

std::vector<glm::vec3> normals_on_cpu(const TexelTable& table, const SeamTable& seams,
                                      const std::vector<SurfaceMetric>& metrics,
                                      const std::vector<float>& height) {
  const std::vector<float> along_u = differences(seams.u, height);
  const std::vector<float> along_v = differences(seams.v, height);
  std::vector<glm::vec3> normals(height.size());
  for (size_t i = 0; i < height.size(); ++i) {
    normals[i] = tangent_normal(metrics[table.triangle[i]], along_u[i], along_v[i]);
  }
  return normals;
}

std::vector<glm::vec3> normal_map(const TexelTable& table, const SeamTable& seams,
                                  const std::vector<SurfaceMetric>& metrics,
                                  const std::vector<float>& map) {
  std::vector<float> height(table.texel.size());
  for (size_t i = 0; i < height.size(); ++i) height[i] = map[table.texel[i]];
  return dilate_normals(table, seams, normals_on_cpu(table, seams, metrics, height));
}

}  // namespace snowbough::snow
