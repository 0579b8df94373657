#include "render/snow/bend.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "render/snow/snow_patches.h"

namespace snowbough::render {
namespace {

using glm::vec2;
using glm::vec3;

/// A strip across a cylinder of 1 m around the y axis, its normals 2 * `turn` apart. Two triangles
/// that its map has `texels` for a side.
SnowSource strip(float turn, int32_t texels, bool is_smooth) {
  const float x = std::sin(turn), z = std::cos(turn);
  const vec3 left(-x, 0, z), right(x, 0, z), up(0, 0, 1);
  SnowSource source;
  source.positions = {left, right, right + vec3(0, 0.5f, 0), left + vec3(0, 0.5f, 0)};
  source.triangles = {{0, 1, 2}, {0, 2, 3}};
  source.uv = {{vec2(0, 0), vec2(1, 0), vec2(1, 1)}, {vec2(0, 0), vec2(1, 1), vec2(0, 1)}};
  source.normals = {{left, right, right}, {left, right, left}};
  if (!is_smooth) source.normals = {{up, up, up}, {up, up, up}};
  source.resolution = texels;
  return source;
}

/// The bend in the middle of the edge from vertex 0 to 1.
vec3 middle_of(const SnowPatches& mesh) {
  for (size_t e = 0; e < mesh.edges.size(); ++e) {
    if (mesh.edges[e].ends.x == 0 && mesh.edges[e].ends.y == 1) {
      return 0.25f * vec3(mesh.edge_bends[e]);
    }
  }
  ADD_FAILURE() << "there is no such edge";
  return {};
}

TEST(Bend, reachesTheCylinderThatTheNormalsTellOf) {
  const float turn = 0.2f;
  const SnowMesh mesh(strip(turn, 16, true));
  ASSERT_EQ(mesh.patches().patches.size(), 2u);
  for (const shared::SnowVertex& vertex : mesh.patches().vertices) {
    EXPECT_EQ(vec3(vertex.bend), vec3(0.0f));
  }
  const vec3 bend = middle_of(mesh.patches());
  // An arc of radius 1 stands 1 - cos(turn) over its chord.
  EXPECT_NEAR(bend.z / (1.0f - std::cos(turn)), 1.0f, 0.03f);
  EXPECT_NEAR(bend.x, 0.0f, 1e-6f);
  EXPECT_NEAR(bend.y, 0.0f, 1e-6f);
}

TEST(Bend, aSurfaceThatIsShadedFlatHasNone) {
  const SnowMesh mesh(strip(0.2f, 16, false));
  EXPECT_LT(glm::length(middle_of(mesh.patches())), 1e-6f);
}

TEST(Bend, cutsLieOnTheSameSurface) {
  const float turn = 0.2f;
  const float whole = middle_of(SnowMesh(strip(turn, 16, true)).patches()).z;
  const SnowMesh mesh(strip(turn, 64, true));
  ASSERT_GT(mesh.patches().patches.size(), 2u);
  int found = 0;
  for (const shared::SnowVertex& vertex : mesh.patches().vertices) {
    if (std::abs(vertex.position.x) > 1e-6f || vertex.position.y > 1e-6f) continue;
    EXPECT_NEAR(vertex.bend.z, whole, 1e-6f);
    ++found;
  }
  EXPECT_EQ(found, 1);
}

TEST(Bend, followsThePose) {
  SnowMesh mesh(strip(0.2f, 16, true));
  const SnowSource wider = strip(0.4f, 16, true);
  const float before = middle_of(mesh.patches()).z;
  mesh.set_pose(wider.positions, wider.normals);
  EXPECT_GT(middle_of(mesh.patches()).z, 3.0f * before);
}

}  // namespace
}  // namespace snowbough::render
