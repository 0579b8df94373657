#include "tree/mesh/mesh_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

namespace snowbough::tree {
namespace {

using testing::ElementsAre;

/// A unit cube whose lowest corner is `at`; its corners are numbered from `first` on.
void add_cube(const glm::vec3& at, std::vector<glm::vec3>& vertices, std::vector<Quad>& quads) {
  constexpr Quad kSides[] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                             {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
  const auto first = static_cast<int32_t>(vertices.size());
  for (const glm::vec3 p :
       {glm::vec3(0, 0, 0), glm::vec3(1, 0, 0), glm::vec3(1, 1, 0), glm::vec3(0, 1, 0),
        glm::vec3(0, 0, 1), glm::vec3(1, 0, 1), glm::vec3(1, 1, 1), glm::vec3(0, 1, 1)}) {
    vertices.push_back(at + p);
  }
  for (Quad side : kSides) {
    for (int32_t& v : side) {
      v += first;
    }
    quads.push_back(side);
  }
}

/// Makes vertex `from` the same as `to`.
void weld(std::vector<Quad>& quads, int32_t from, int32_t to) {
  for (Quad& quad : quads) {
    std::replace(quad.begin(), quad.end(), from, to);
  }
}

TEST(MeshCheck, TwoCubesApartAreTwoClosedPieces) {
  std::vector<glm::vec3> vertices;
  std::vector<Quad> quads;
  add_cube({0, 0, 0}, vertices, quads);
  add_cube({5, 0, 0}, vertices, quads);
  const MeshCheck check = check_mesh(vertices, quads);
  EXPECT_TRUE(check.closed() && check.winding_ok);
  EXPECT_THAT(check.euler, ElementsAre(2, 2));
  EXPECT_NEAR(check.volume, 2.0, 1e-6);
}

TEST(MeshCheck, CubesThatShareACornerPinchIt) {
  std::vector<glm::vec3> vertices;
  std::vector<Quad> quads;
  add_cube({0, 0, 0}, vertices, quads);
  add_cube({1, 1, 1}, vertices, quads);
  weld(quads, 8, 6);
  const MeshCheck check = check_mesh(vertices, quads);
  EXPECT_EQ(check.components, 1);
  EXPECT_EQ(check.boundary_edges, 0);
  EXPECT_GT(check.nonmanifold_faces, 0);
  EXPECT_FALSE(check.closed());
  EXPECT_EQ(check.unused_vertices, 1);
}

TEST(MeshCheck, CubesThatShareAnEdgeHaveANonmanifoldEdge) {
  std::vector<glm::vec3> vertices;
  std::vector<Quad> quads;
  add_cube({0, 0, 0}, vertices, quads);
  add_cube({1, 1, 0}, vertices, quads);
  weld(quads, 8, 2);
  weld(quads, 12, 6);
  const MeshCheck check = check_mesh(vertices, quads);
  EXPECT_EQ(check.nonmanifold_edges, 1);
  EXPECT_FALSE(check.closed());
}

TEST(MeshCheck, AnOpenBoxIsADiscWithABorder) {
  std::vector<glm::vec3> vertices;
  std::vector<Quad> quads;
  add_cube({0, 0, 0}, vertices, quads);
  quads.erase(quads.begin() + 1);
  const MeshCheck check = check_mesh(vertices, quads);
  EXPECT_EQ(check.boundary_edges, 4);
  EXPECT_EQ(check.nonmanifold_faces, 0);
  EXPECT_THAT(check.euler, ElementsAre(1));
  // A border encloses nothing: its volume says nothing about the winding.
  EXPECT_TRUE(check.winding_ok);
}

TEST(MeshCheck, ATubeOpenAtBothEndsHasNoEulerNumber) {
  std::vector<glm::vec3> vertices;
  std::vector<Quad> quads;
  add_cube({0, 0, 0}, vertices, quads);
  quads.erase(quads.begin(), quads.begin() + 2);
  EXPECT_THAT(check_mesh(vertices, quads).euler, ElementsAre(0));
}

TEST(MeshCheck, AFaceWithARepeatedCornerIsNoFace) {
  std::vector<glm::vec3> vertices;
  std::vector<Quad> quads;
  add_cube({0, 0, 0}, vertices, quads);
  quads.push_back({0, 0, 1, 2});
  const MeshCheck check = check_mesh(vertices, quads);
  EXPECT_EQ(check.zero_area_faces, 1);
  EXPECT_GE(check.nonmanifold_faces, 1);
}

TEST(MeshCheck, AnInsideOutCubeIsWoundWrongly) {
  std::vector<glm::vec3> vertices;
  std::vector<Quad> quads;
  add_cube({0, 0, 0}, vertices, quads);
  for (Quad& quad : quads) {
    std::reverse(quad.begin(), quad.end());
  }
  const MeshCheck check = check_mesh(vertices, quads);
  EXPECT_TRUE(check.closed());
  EXPECT_FALSE(check.winding_ok);
  EXPECT_NEAR(check.volume, -1.0, 1e-6);
}

TEST(MeshCheck, FindsWhatIsWrongWithACube) {
  const std::vector<glm::vec3> corners = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                          {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  const std::vector<Quad> cube = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                  {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
  const MeshCheck good = check_mesh(corners, cube);
  EXPECT_TRUE(good.closed() && good.winding_ok);
  EXPECT_THAT(good.euler, ElementsAre(2));
  EXPECT_NEAR(good.volume, 1.0, 1e-6);

  const MeshCheck open = check_mesh(corners, {cube.begin(), cube.end() - 1});
  EXPECT_EQ(open.boundary_edges, 4);
  EXPECT_THAT(open.euler, ElementsAre(1));

  std::vector<Quad> flipped = cube;
  std::reverse(flipped[0].begin(), flipped[0].end());
  EXPECT_EQ(check_mesh(corners, flipped).flipped_edges, 4);
  EXPECT_FALSE(check_mesh(corners, flipped).winding_ok);

  std::vector<Quad> doubled = cube;
  doubled.push_back(cube[0]);
  EXPECT_EQ(check_mesh(corners, doubled).nonmanifold_edges, 4);

  std::vector<glm::vec3> flat = corners;
  flat[4] = flat[5] = flat[6] = flat[7] = {0.5f, 0.5f, 1.0f};
  EXPECT_EQ(check_mesh(flat, cube).zero_area_faces, 1);
}

}  // namespace
}  // namespace snowbough::tree
