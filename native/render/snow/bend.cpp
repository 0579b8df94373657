#include "render/snow/bend.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "render/snow/snow_patches.h"

namespace snowbough::render {
namespace {

using glm::vec3;
using glm::vec4;

/// Share of Phong tessellation.
constexpr float kShare = 0.5f;

vec3 unit(const vec3& v, const vec3& otherwise) {
  const float length = glm::length(v);
  return length > 1e-20f ? v / length : otherwise;
}

/// Smooth normals by vertex, faces weighted by the angle of their corner.
std::vector<vec3> smooth_normals(const SnowSource& source) {
  std::vector<vec3> sums(source.positions.size(), vec3(0.0f));
  for (const auto& triangle : source.triangles) {
    for (int k = 0; k < 3; ++k) {
      const vec3 at = source.positions[triangle[k]];
      const vec3 next = source.positions[triangle[(k + 1) % 3]] - at;
      const vec3 last = source.positions[triangle[(k + 2) % 3]] - at;
      const vec3 across = glm::cross(next, last);
      const float size = glm::length(across);
      if (size > 0.0f)
        sums[triangle[k]] += across * (std::atan2(size, glm::dot(next, last)) / size);
    }
  }
  for (vec3& sum : sums) sum = unit(sum, vec3(0.0f, 0.0f, 1.0f));
  return sums;
}

/// What Phong tessellation adds over a triangle, as a form of the corners' weights: `of(w, w)` at a
/// point, and `of(a - b, a - b)` for the way between two.
class PhongForm {
 public:
  PhongForm(const std::array<vec3, 3>& corners, const std::array<vec3, 3>& normals) {
    for (int i = 0; i < 3; ++i) {
      const vec3 n = unit(normals[i], vec3(0.0f));
      for (const int j : {(i + 1) % 3, (i + 2) % 3}) {
        toward_[i][j] = -kShare * glm::dot(corners[j] - corners[i], n) * n;
      }
    }
  }
  vec3 of(const vec3& v, const vec3& w) const {
    vec3 sum(0.0f);
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) sum += v[i] * w[j] * toward_[i][j];
    }
    return sum;
  }
  /// -of(w, w) for the way from corner i to corner j.
  vec3 along(int i, int j) const { return toward_[i][j] + toward_[j][i]; }

 private:
  /// From corner i's tangent plane to corner j.
  vec3 toward_[3][3]{};
};

}  // namespace

std::vector<std::array<vec3, 3>> growth_directions(const SnowSource& source) {
  if (!source.normals.empty()) return source.normals;
  const std::vector<vec3> smooth = smooth_normals(source);
  std::vector<std::array<vec3, 3>> corners;
  corners.reserve(source.triangles.size());
  for (const auto& triangle : source.triangles) {
    corners.push_back({smooth[triangle[0]], smooth[triangle[1]], smooth[triangle[2]]});
  }
  return corners;
}

void find_bends(const SnowSource& source, const RefinedMesh& refined,
                const std::vector<std::array<vec3, 3>>& directions, SnowPatches& patches) {
  // Sums, and in w how many.
  std::vector<vec4> vertices(patches.vertices.size(), vec4(0.0f));
  std::vector<vec4> edges(patches.edges.size(), vec4(0.0f));
  for (size_t t = 0; t < refined.triangles.size(); ++t) {
    const int32_t of = refined.source_triangle[t];
    std::array<vec3, 3> corners;
    for (int k = 0; k < 3; ++k) corners[k] = source.positions[source.triangles[of][k]];
    const PhongForm form(corners, directions[of]);
    const auto& weights = refined.corner_weights[t];
    const bool is_whole = weights[0].x == 1.0f && weights[1].y == 1.0f && weights[2].z == 1.0f;
    for (int k = 0; k < 3; ++k) {
      const int next = (k + 1) % 3;
      const vec3 way = weights[next] - weights[k];
      vec4& edge = edges[patches.patches[t].edges[k] >> 1];
      edge += vec4(is_whole ? form.along(k, next) : -form.of(way, way), 1.0f);
      if (is_whole) continue;  // corners have no bend
      vertices[refined.triangles[t][k]] += vec4(form.of(weights[k], weights[k]), 1.0f);
    }
  }
  const auto mean = [](const vec4& sum) { return vec4(vec3(sum) / std::max(sum.w, 1.0f), 0.0f); };
  for (size_t v = 0; v < vertices.size(); ++v) patches.vertices[v].bend = mean(vertices[v]);
  patches.edge_bends.clear();
  for (const vec4& sum : edges) patches.edge_bends.push_back(mean(sum));
}

}  // namespace snowbough::render
