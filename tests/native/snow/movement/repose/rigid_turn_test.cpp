#include "snow/movement/repose/rigid_turn.h"

#include <gtest/gtest.h>

namespace snowbough::snow {
namespace {

const std::vector<glm::vec3> kPoints{{0, 0, 0}, {0.1f, 0, 0}, {2, 0, 0}, {1, 1, 0}, {0, 0, 0.5f}};

/// A quarter turn about z, which takes x to y, and a shift.
std::vector<glm::vec3> moved(std::vector<glm::vec3> points) {
  for (glm::vec3& p : points) p = {3.0f - p.y, p.x, p.z + 1.0f};
  return points;
}

TEST(RigidTurn, IsFoundFromThreePointsFarApart) {
  const std::vector<glm::vec3> to = moved(kPoints);
  const std::array<size_t, 3> corners = far_apart(kPoints, kPoints.size());
  EXPECT_EQ(corners, (std::array<size_t, 3>{0, 2, 3}));
  const auto turn = turn_between(kPoints, to, corners);
  ASSERT_TRUE(turn);
  const glm::dvec3 x = *turn * glm::dvec3(1, 0, 0);
  EXPECT_NEAR(glm::distance(x, glm::dvec3(0, 1, 0)), 0.0, 1e-6);
  EXPECT_NEAR(largest_error(kPoints, to, kPoints.size(), *turn, corners[0]), 0.0, 1e-6);
}

TEST(RigidTurn, LeavesAsErrorHowFarAPointHasMovedByItself) {
  std::vector<glm::vec3> to = moved(kPoints);
  to[4].z += 0.25f;
  const std::array<size_t, 3> corners = far_apart(kPoints, kPoints.size());
  const auto turn = turn_between(kPoints, to, corners);
  ASSERT_TRUE(turn);
  EXPECT_NEAR(largest_error(kPoints, to, 5, *turn, corners[0]), 0.25, 1e-6);
  EXPECT_NEAR(largest_error(kPoints, to, 4, *turn, corners[0]), 0.0, 1e-6);
}

TEST(RigidTurn, OfPointsOnALineIsNone) {
  const std::vector<glm::vec3> line{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  EXPECT_FALSE(turn_between(line, line, {0, 1, 2}));
}

}  // namespace
}  // namespace snowbough::snow
