#include "snow/seams/surface_metric.h"

#include <cmath>
#include <glm/geometric.hpp>

namespace snowbough::snow {

std::vector<SurfaceMetric> surface_metrics(const MapTopology& topology,
                                           const std::vector<glm::vec3>& positions) {
  std::vector<SurfaceMetric> metrics(topology.triangles.size() / 3);
  for (size_t t = 0; t < metrics.size(); ++t) {
    const int32_t* corner = topology.triangles.data() + 3 * t;
    const glm::vec2* uv = topology.corner_uv.data() + 3 * t;
    const glm::dvec3 a(positions[corner[0]]);
    const glm::dvec3 edge_b = glm::dvec3(positions[corner[1]]) - a;
    const glm::dvec3 edge_c = glm::dvec3(positions[corner[2]]) - a;
    const auto size = static_cast<double>(topology.resolution);
    const glm::dvec2 b = (glm::dvec2(uv[1]) - glm::dvec2(uv[0])) * size;
    const glm::dvec2 c = (glm::dvec2(uv[2]) - glm::dvec2(uv[0])) * size;
    const double determinant = b.x * c.y - b.y * c.x;
    if (std::abs(determinant) < 1e-12) continue;
    const glm::dvec3 along_u = (edge_b * c.y - edge_c * b.y) / determinant;
    const glm::dvec3 along_v = (edge_c * b.x - edge_b * c.x) / determinant;
    metrics[t] = {static_cast<float>(glm::dot(along_u, along_u)),
                  static_cast<float>(glm::dot(along_u, along_v)),
                  static_cast<float>(glm::dot(along_v, along_v))};
  }
  return metrics;
}

std::vector<float> texel_areas(const MapTopology& topology, const TexelTable& table,
                               const std::vector<glm::vec3>& positions) {
  std::vector<float> triangle_area(topology.triangles.size() / 3);
  for (size_t t = 0; t < triangle_area.size(); ++t) {
    const glm::dvec3 a(positions[static_cast<size_t>(topology.triangles[3 * t])]);
    const glm::dvec3 b(positions[static_cast<size_t>(topology.triangles[3 * t + 1])]);
    const glm::dvec3 c(positions[static_cast<size_t>(topology.triangles[3 * t + 2])]);
    triangle_area[t] = static_cast<float>(0.5 * glm::length(glm::cross(b - a, c - a)));
  }
  std::vector<float> areas(table.texel.size(), 0.0f);
  for (size_t i = 0; i < areas.size(); ++i) {
    for (int32_t f = table.fragment_begin[i]; f < table.fragment_begin[i + 1]; ++f) {
      const auto fragment = static_cast<size_t>(f);
      areas[i] += table.fragment_share[fragment] *
                  triangle_area[static_cast<size_t>(table.fragment_triangle[fragment])];
    }
  }
  return areas;
}

}  // namespace snowbough::snow
