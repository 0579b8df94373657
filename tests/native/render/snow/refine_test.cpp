#include "render/snow/refine.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <map>

namespace snowbough::render {
namespace {

using glm::vec2;
using glm::vec3;

/// A square metre as two triangles; the second covers a smaller part of the map.
SnowSource square() {
  SnowSource source;
  source.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  source.triangles = {{0, 1, 2}, {0, 2, 3}};
  source.uv = {{vec2(0.0f), vec2(1, 0), vec2(1, 1)}, {vec2(0.0f), vec2(0.1f, 0.1f), vec2(0, 0.1f)}};
  return source;
}

vec3 position(const RefinedMesh& mesh, const SnowSource& source, int32_t vertex) {
  const auto& parents = mesh.vertex_parents[vertex];
  const vec3 w = mesh.vertex_weights[vertex];
  return w.x * source.positions[parents[0]] + w.y * source.positions[parents[1]] +
         w.z * source.positions[parents[2]];
}

TEST(Refine, leavesWhatIsSmallEnough) {
  const RefinedMesh mesh = refine(square(), 16, 32.0f);
  EXPECT_EQ(mesh.triangles, square().triangles);
  EXPECT_EQ(mesh.vertex_parents.size(), 4u);
}

TEST(Refine, cutsUntilNoEdgeCoversMoreTexels) {
  const SnowSource source = square();
  const RefinedMesh mesh = refine(source, 256, 32.0f);
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& uv = source.uv[mesh.source_triangle[t]];
    for (int k = 0; k < 3; ++k) {
      const vec3 a = mesh.corner_weights[t][k], b = mesh.corner_weights[t][(k + 1) % 3];
      const vec3 d = b - a;
      EXPECT_LE(256.0f * glm::length(d.x * uv[0] + d.y * uv[1] + d.z * uv[2]), 32.0f);
    }
  }
}

TEST(Refine, bothFacesOfAnEdgeHaveItsCutsAndTheSurfaceStays) {
  const SnowSource source = square();
  const RefinedMesh mesh = refine(source, 256, 32.0f);
  std::map<std::pair<int32_t, int32_t>, int> sides;
  float area = 0.0f;
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& v = mesh.triangles[t];
    vec3 at[3];
    for (int k = 0; k < 3; ++k) {
      ++sides[{std::min(v[k], v[(k + 1) % 3]), std::max(v[k], v[(k + 1) % 3])}];
      at[k] = position(mesh, source, v[k]);
      const auto& corner = source.triangles[mesh.source_triangle[t]];
      const vec3 w = mesh.corner_weights[t][k];
      const vec3 own = w.x * source.positions[corner[0]] + w.y * source.positions[corner[1]] +
                       w.z * source.positions[corner[2]];
      EXPECT_NEAR(glm::distance(own, at[k]), 0.0f, 1e-6f);
    }
    const vec3 across = glm::cross(at[1] - at[0], at[2] - at[0]);
    EXPECT_GT(across.z, 0.0f);
    area += 0.5f * across.z;
  }
  EXPECT_NEAR(area, 1.0f, 1e-5f);
  for (const auto& [side, count] : sides) {
    const vec3 a = position(mesh, source, side.first), b = position(mesh, source, side.second);
    const vec3 middle = 0.5f * (a + b);
    const bool on_border = std::min({middle.x, middle.y, 1 - middle.x, 1 - middle.y}) < 1e-6f;
    EXPECT_EQ(count, on_border ? 1 : 2);
  }
}

}  // namespace
}  // namespace snowbough::render
