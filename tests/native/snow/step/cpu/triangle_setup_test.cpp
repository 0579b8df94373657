#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "native/snow/step/cpu/seen.h"

namespace snowbough::snow {
namespace {

TEST(CpuTriangleSetup, GivesCornersOnTheGridSlopesAndArea) {
  shared::ProjectionFrame frame{};
  frame.anchor = {1, 2, 3, 0};
  frame.grid_x = {10, 0, 0, 0.5f};
  frame.grid_y = {0, 10, 0, 0.25f};
  frame.direction = {0, 0, -1, 0.1f};
  // Rises by one along x.
  const TrianglesSetUp made = set_up({{1, 2, 3}, {2, 2, 4}, {1, 3, 3}}, {{0, 1, 2, 0}}, frame);
  const float facing = std::sqrt(0.5f);
  EXPECT_EQ(glm::vec3(made.corners[0]), glm::vec3(0.5f, 0.25f, 0.0f));
  EXPECT_EQ(glm::vec3(made.corners[1]), glm::vec3(10.5f, 0.25f, -1.0f));
  EXPECT_EQ(glm::vec3(made.corners[2]), glm::vec3(0.5f, 10.25f, 0.0f));
  EXPECT_NEAR(made.corners[0].w, -0.1f, 1e-7f);
  EXPECT_NEAR(made.corners[1].w, 0.0f, 1e-7f);
  EXPECT_NEAR(made.corners[2].w, facing, 1e-6f);
  EXPECT_NEAR(made.surface[0].x, facing, 1e-6f);
  EXPECT_NEAR(made.surface[0].y, 0.5f * std::sqrt(2.0f), 1e-6f);
  EXPECT_NEAR(made.surface[0].z, facing, 1e-6f);
}

TEST(CpuTriangleSetup, ATriangleWithoutAreaFacesNowhere) {
  shared::ProjectionFrame frame{};
  frame.direction = {0, 0, -1, 0.1f};
  const TrianglesSetUp made = set_up({{1, 2, 3}, {2, 2, 4}}, {{0, 1, 0, 0}, {0, 0, 0, 0}}, frame);
  EXPECT_EQ(made.surface[0], glm::vec4(0.0f));
  EXPECT_EQ(made.surface[1], glm::vec4(0.0f));
}

TEST(CpuTriangleSetup, RefusesBuffersOfTheWrongSize) {
  const std::vector<shared::SceneTriangle> triangles(2);
  const std::vector<glm::vec3> positions(1);
  Corners corners(5);
  std::vector<glm::vec4> surface(2);
  EXPECT_THROW(cpu::set_up_triangles(positions, triangles, {}, corners, surface),
               std::invalid_argument);
}

}  // namespace
}  // namespace snowbough::snow
