#include "render/snow/snow_patches.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace snowbough::render {
namespace {

using glm::vec2;
using glm::vec3;

/// A roof: two square metres that meet in the ridge x = 0, each a chart of its own.
SnowSource roof(bool is_smooth) {
  SnowSource source;
  source.positions = {{-1, 0, 0}, {0, 0, 1}, {0, 1, 1}, {-1, 1, 0}, {1, 0, 0}, {1, 1, 0}};
  source.triangles = {{0, 1, 2}, {0, 2, 3}, {1, 4, 5}, {1, 5, 2}};
  const auto uv = [](float left) {
    return std::array<vec2, 4>{vec2(left, 0.1f), vec2(left + 0.4f, 0.1f), vec2(left + 0.4f, 0.5f),
                               vec2(left, 0.5f)};
  };
  const auto a = uv(0.05f), b = uv(0.55f);
  source.uv = {{a[0], a[1], a[2]}, {a[0], a[2], a[3]}, {b[0], b[1], b[2]}, {b[0], b[2], b[3]}};
  const vec3 left = glm::normalize(vec3(-1, 0, 1)), right = glm::normalize(vec3(1, 0, 1));
  if (!is_smooth) {
    source.normals = {
        {left, left, left}, {left, left, left}, {right, right, right}, {right, right, right}};
  }
  source.resolution = 64;
  return source;
}

TEST(SnowPatches, eachEdgeHasOneRecordWithBothSidesPlaces) {
  const SnowMesh made(roof(false));
  const SnowPatches& mesh = made.patches();
  int ridges = 0;
  for (const shared::SnowEdge& edge : mesh.edges) {
    const vec3 a = vec3(mesh.vertices[edge.ends.x].position);
    const vec3 b = vec3(mesh.vertices[edge.ends.y].position);
    if (a.x != 0.0f || b.x != 0.0f) continue;
    ++ridges;
    EXPECT_EQ(edge.ends.z, 0);
    EXPECT_NEAR(std::min(edge.uv.x, edge.other_uv.x), 0.45f, 1e-6f);
    EXPECT_NEAR(std::max(edge.uv.x, edge.other_uv.x), 0.55f, 1e-6f);
    EXPECT_FLOAT_EQ(edge.uv.y, edge.other_uv.y);
  }
  EXPECT_GT(ridges, 0);
}

TEST(SnowPatches, verticesKnowHowFarHardEdgesAndTheEndAre) {
  const SnowMesh made(roof(false));
  for (const shared::SnowVertex& vertex : made.patches().vertices) {
    const vec3 p = vec3(vertex.position);
    EXPECT_NEAR(vertex.rims.x, std::abs(p.x) * std::sqrt(2.0f), 1e-5f);
    const float end = std::min({p.y, 1.0f - p.y, (1.0f - std::abs(p.x)) * std::sqrt(2.0f)});
    EXPECT_NEAR(vertex.rims.z, end, 1e-5f);
  }
}

TEST(SnowPatches, aSmoothMeshHasNoHardEdges) {
  const SnowMesh made(roof(true));
  for (const shared::SnowVertex& vertex : made.patches().vertices) {
    EXPECT_EQ(vertex.corners.z, -1);
    EXPECT_EQ(vertex.rims.x, shared::kNoRim);
  }
}

TEST(SnowPatches, aPoseMovesWhatDependsOnPositionsAlone) {
  const SnowSource source = roof(false);
  SnowMesh mesh(source);
  const SnowPatches before = mesh.patches();
  std::vector<vec3> moved = source.positions;
  for (vec3& p : moved) p = vec3(-p.y, p.x, p.z + 2.0f);
  mesh.set_pose(moved, {});
  const SnowPatches& after = mesh.patches();
  for (size_t v = 0; v < before.vertices.size(); ++v) {
    const vec3 p = vec3(before.vertices[v].position);
    EXPECT_NEAR(glm::distance(vec3(after.vertices[v].position), vec3(-p.y, p.x, p.z + 2.0f)), 0.0f,
                1e-5f);
    EXPECT_EQ(after.vertices[v].rest, before.vertices[v].rest);
    EXPECT_NEAR(after.vertices[v].position.w, before.vertices[v].position.w, 1e-6f);
  }
}

TEST(SnowPatches, threeFacesAtAnEdgeAreRefused) {
  SnowSource source = roof(true);
  source.positions.emplace_back(0.0f, 0.5f, 2.0f);
  source.triangles.push_back({1, 2, 6});
  source.uv.push_back(source.uv[0]);
  EXPECT_THROW(SnowMesh{source}, std::invalid_argument);
}

}  // namespace
}  // namespace snowbough::render
