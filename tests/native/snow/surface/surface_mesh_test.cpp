#include "snow/surface/surface_mesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <iostream>
#include <random>

#include "native/snow/surface/shapes.h"

namespace snowbough::snow {
namespace {

using testing::ElementsAre;

/// A level square of a metre in 2 n^2 triangles whose texture coordinates are its x and y.
SurfaceMesh square(int32_t n) {
  SurfaceMesh mesh;
  for (int32_t y = 0; y <= n; ++y) {
    for (int32_t x = 0; x <= n; ++x) {
      mesh.position.push_back(glm::vec3(x, y, 0) / static_cast<float>(n));
    }
  }
  for (int32_t y = 0; y < n; ++y) {
    for (int32_t x = 0; x < n; ++x) {
      const int32_t a = y * (n + 1) + x;
      mesh.triangle.push_back({a, a + 1, a + n + 2});
      mesh.triangle.push_back({a, a + n + 2, a + n + 1});
    }
  }
  for (const auto& [a, b, c] : mesh.triangle) {
    mesh.uv.push_back(
        {glm::vec2(mesh.position[a]), glm::vec2(mesh.position[b]), glm::vec2(mesh.position[c])});
    mesh.normal.push_back({glm::vec3(0, 0, 1), glm::vec3(0, 0, 1), glm::vec3(0, 0, 1)});
    mesh.base.push_back(static_cast<int32_t>(mesh.base.size()));
  }
  return mesh;
}

/// The square with about half of its edges split at random places, three times over.
SurfaceMesh split_at_random() {
  const auto seed = std::random_device{}();
  std::cout << "seed " << seed << '\n';
  std::mt19937 random(seed);
  SurfaceMesh mesh = square(3);
  for (int round = 0; round < 3; ++round) {
    const SurfaceEdges edges = surface_edges(mesh.triangle);
    std::vector<float> share(edges.ends.size());
    for (float& at : share) at = std::uniform_real_distribution<float>(-0.6f, 0.7f)(random);
    for (float& at : share) at = at < 0.0f ? 0.0f : at + 0.15f;
    split_edges(mesh, edges, share);
  }
  return mesh;
}

TEST(SurfaceEdges, TwoTrianglesThatMeetHaveFive) {
  const SurfaceEdges edges = surface_edges({{0, 1, 2}, {0, 2, 3}});
  EXPECT_THAT(edges.ends, ElementsAre(ElementsAre(0, 1), ElementsAre(0, 2), ElementsAre(0, 3),
                                      ElementsAre(1, 2), ElementsAre(2, 3)));
  EXPECT_THAT(edges.of_triangle, ElementsAre(ElementsAre(0, 3, 1), ElementsAre(1, 4, 2)));
}

TEST(ReceiverMesh, PointsInOnePlaceAreOne) {
  SurfaceSource source = quads(
      {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}},
      {{0, 1, 2, 3}, {4, 5, 6, 7}});
  EXPECT_EQ(receiver_mesh(source).position.size(), 6u);
}

TEST(ReceiverMesh, FacesWithoutAreaAreLeftOut) {
  SurfaceSource source =
      quads({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 1, 0}, {0, 1, 2, 3}});
  EXPECT_THAT(receiver_mesh(source).base, ElementsAre(2, 3));
}

TEST(ReceiverMesh, SmoothCornersShareAMeanNormalAndFlatOnesDoNot) {
  // A roof of two slopes of 45 degrees; the ridge is smooth, the eaves are flat.
  SurfaceSource source = quads({{-1, 0, 0}, {-1, 1, 0}, {0, 1, 1}, {0, 0, 1}, {1, 0, 0}, {1, 1, 0}},
                               {{0, 3, 2, 1}, {3, 4, 5, 2}});
  for (const int32_t v : source.topology.triangles)
    source.shading.push_back(v == 2 || v == 3 ? v : -1);
  const SurfaceMesh mesh = receiver_mesh(source);
  for (size_t t = 0; t < mesh.triangle.size(); ++t) {
    for (size_t k = 0; k < 3; ++k) {
      const bool ridge = mesh.position[mesh.triangle[t][k]].z == 1.0f;
      EXPECT_NEAR(mesh.normal[t][k].z, ridge ? 1.0f : std::sqrt(0.5f), 1e-6f);
    }
  }
}

TEST(Submesh, HasNoPointsThatItsTrianglesDoNotUse) {
  const SurfaceMesh part = submesh(square(2), {1, 0, 0, 0, 0, 0, 0, 0});
  EXPECT_EQ(part.position.size(), 3u);
  EXPECT_THAT(part.triangle, ElementsAre(ElementsAre(0, 1, 2)));
}

TEST(SplitEdges, LeavesNoTJunctions) {
  const SurfaceMesh mesh = split_at_random();
  const SurfaceEdges edges = surface_edges(mesh.triangle);
  const std::vector<int32_t> faces = faces_at_edges(edges);
  for (size_t e = 0; e < edges.ends.size(); ++e) {
    const glm::vec3 a = mesh.position[edges.ends[e][0]], b = mesh.position[edges.ends[e][1]];
    // An edge with one face lies on the outline of the square.
    bool outline = false;
    for (int axis = 0; axis < 2; ++axis) {
      for (const float side : {0.0f, 1.0f})
        outline = outline || (a[axis] == side && b[axis] == side);
    }
    EXPECT_EQ(faces[e], outline ? 1 : 2);
  }
}

TEST(SplitEdges, KeepsTheArea) {
  const SurfaceMesh mesh = split_at_random();
  EXPECT_NEAR(area_of(mesh), 1.0f, 1e-6f);
  for (size_t t = 0; t < mesh.triangle.size(); ++t) EXPECT_GT(triangle_cross(mesh, t).z, 0.0f);
}

TEST(SplitEdges, KeepsTextureCoordinates) {
  const SurfaceMesh mesh = split_at_random();
  for (size_t t = 0; t < mesh.triangle.size(); ++t) {
    for (size_t k = 0; k < 3; ++k) {
      EXPECT_LT(glm::distance(mesh.uv[t][k], glm::vec2(mesh.position[mesh.triangle[t][k]])), 1e-6f);
    }
  }
}

TEST(SplitEdges, SplitsAtTheShareOfTheWayFromTheSmallerPoint) {
  SurfaceMesh mesh = square(1);
  const SurfaceEdges edges = surface_edges(mesh.triangle);
  split_edges(mesh, edges, {0.25f, 0.0f, 0.0f, 0.0f, 0.0f});
  ASSERT_EQ(mesh.position.size(), 5u);
  EXPECT_EQ(mesh.position[4], glm::vec3(0.25f, 0.0f, 0.0f));
  EXPECT_EQ(mesh.triangle.size(), 3u);
}

TEST(MarkLongest, MarksTheLongestEdgeOfTrianglesWithAMarkedOne) {
  const SurfaceMesh mesh = square(1);
  const SurfaceEdges edges = surface_edges(mesh.triangle);
  // Edges: 0-1, 0-2, 0-3 (the diagonal), 1-3, 2-3.
  std::vector<uint8_t> marked{1, 0, 0, 0, 0};
  mark_longest(mesh, edges, std::vector<uint8_t>(edges.ends.size(), 0), marked);
  EXPECT_THAT(marked, ElementsAre(1, 0, 1, 0, 0));
}

TEST(MarkLongest, LeavesSparedEdgesOut) {
  const SurfaceMesh mesh = square(1);
  const SurfaceEdges edges = surface_edges(mesh.triangle);
  std::vector<uint8_t> marked{1, 0, 0, 0, 0};
  mark_longest(mesh, edges, {0, 0, 1, 0, 0}, marked);
  EXPECT_THAT(marked, ElementsAre(1, 0, 0, 0, 0));
}

}  // namespace
}  // namespace snowbough::snow
