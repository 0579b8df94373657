#include "snow/surface/flip_edges.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "native/snow/surface/shapes.h"

namespace snowbough::snow {
namespace {

using testing::UnorderedElementsAre;

/// A square cut along the diagonal from 0 to 2, both halves of one face of the receiver.
SurfaceMesh cut_square() {
  SurfaceMesh mesh = receiver_mesh(card(1.0f, 1.0f));
  mesh.base = {0, 0};
  return mesh;
}

/// The square with its corners 0 and 2 raised: the diagonal 1-3 is the shorter one.
std::vector<glm::vec3> folded(const SurfaceMesh& mesh) {
  std::vector<glm::vec3> shown = mesh.position;
  shown[0].z = 0.6f;
  shown[2].z = -0.6f;
  return shown;
}

bool has_edge(const SurfaceMesh& mesh, int32_t a, int32_t b) {
  const SurfaceEdges edges = surface_edges(mesh.triangle);
  return std::find(edges.ends.begin(), edges.ends.end(), std::array{a, b}) != edges.ends.end();
}

TEST(FlipEdges, TakesTheShorterDiagonalOfTheSnow) {
  SurfaceMesh mesh = cut_square();
  ASSERT_TRUE(has_edge(mesh, 0, 2));
  flip_edges(mesh, folded(mesh));
  EXPECT_TRUE(has_edge(mesh, 1, 3));
  EXPECT_FALSE(has_edge(mesh, 0, 2));
}

TEST(FlipEdges, KeepsAreaSidesAndTextureCoordinates) {
  SurfaceMesh mesh = cut_square();
  flip_edges(mesh, folded(mesh));
  const glm::vec2 low(kGutter / kResolution);
  const float size = 1.0f - 2.0f * low.x;
  EXPECT_NEAR(area_of(mesh), 1.0f, 1e-6f);
  for (size_t t = 0; t < 2; ++t) {
    EXPECT_GT(triangle_cross(mesh, t).z, 0.0f);
    for (size_t k = 0; k < 3; ++k) {
      const glm::vec2 expected =
          low + (glm::vec2(mesh.position[mesh.triangle[t][k]]) + 0.5f) * size;
      EXPECT_LT(glm::distance(mesh.uv[t][k], expected), 1e-6f);
    }
  }
}

TEST(FlipEdges, LeavesDiagonalsThatAreAboutAsLong) {
  SurfaceMesh mesh = cut_square();
  flip_edges(mesh, mesh.position);
  EXPECT_TRUE(has_edge(mesh, 0, 2));
}

TEST(FlipEdges, TakesFlatFacesOfTheReceiverForOne) {
  SurfaceMesh mesh = cut_square();
  mesh.base = {0, 1};
  flip_edges(mesh, folded(mesh));
  EXPECT_TRUE(has_edge(mesh, 1, 3));
}

TEST(FlipEdges, LeavesFoldsOfTheReceiver) {
  SurfaceMesh mesh = cut_square();
  mesh.base = {0, 1};
  mesh.position[1].z = 0.2f;
  flip_edges(mesh, folded(mesh));
  EXPECT_TRUE(has_edge(mesh, 0, 2));
}

TEST(FlipEdges, LeavesSeamsOfTheReceiver) {
  SurfaceMesh mesh = cut_square();
  mesh.base = {0, 1};
  for (glm::vec2& uv : mesh.uv[1]) uv *= 0.5f;
  flip_edges(mesh, folded(mesh));
  EXPECT_TRUE(has_edge(mesh, 0, 2));
}

TEST(FlipEdges, MakesNoFlatTriangles) {
  SurfaceMesh mesh = cut_square();
  // Corner 0 on the diagonal from 1 to 3: turned, one of the halves would have no area.
  mesh.position[0] = glm::vec3(0.0f);
  std::vector<glm::vec3> shown = folded(mesh);
  shown[2].z = -2.0f;
  flip_edges(mesh, shown);
  EXPECT_TRUE(has_edge(mesh, 0, 2));
}

}  // namespace
}  // namespace snowbough::snow
