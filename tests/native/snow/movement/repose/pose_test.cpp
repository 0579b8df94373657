// The part of an object's pose that matters to repose.
#include "snow/movement/repose/pose.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace snowbough::snow {
namespace {

const std::vector<glm::vec3> kRest{
    {0.0f, 0.0f, 0.0f}, {1.0f, 0.0f, 0.1f}, {0.3f, 2.0f, 0.0f}, {0.1f, 0.4f, 1.5f}};

/// The rest pose turned about an axis, by radians, and carried along.
std::vector<glm::vec3> turned(glm::dvec3 axis, double angle, glm::dvec3 offset) {
  axis = glm::normalize(axis);
  std::vector<glm::vec3> result;
  for (const glm::vec3& point : kRest) {
    const glm::dvec3 p(point);
    result.emplace_back(p * std::cos(angle) + glm::cross(axis, p) * std::sin(angle) +
                        axis * glm::dot(axis, p) * (1.0 - std::cos(angle)) + offset);
  }
  return result;
}

TEST(ReposePose, IsTheSameWhileAnObjectTurnsAboutTheVerticalOrIsCarriedAlong) {
  ReposePose pose;
  EXPECT_TRUE(pose.set(kRest, kRest, 4));
  EXPECT_EQ(pose.positions(), kRest);
  for (int i = 1; i < 40; ++i) {
    const auto now = turned({0.0, 0.0, 1.0}, 0.3 * i, {0.7 * i, -0.2 * i, 0.1 * i});
    EXPECT_FALSE(pose.set(kRest, now, 4)) << i;
  }
  EXPECT_EQ(pose.positions(), kRest);
}

TEST(ReposePose, HasTheHeightsOfATiltedObject) {
  ReposePose pose;
  pose.set(kRest, kRest, 4);
  for (const glm::dvec3 axis : {glm::dvec3(1, 0, 0), glm::dvec3(0.3, -1, 0.4)}) {
    for (const double angle : {0.2, 1.5, 3.1, 3.14159265358979}) {
      const std::vector<glm::vec3> now = turned(axis, angle, {3.0, 1.0, 2.0});
      EXPECT_TRUE(pose.set(kRest, now, 4));
      const std::vector<glm::vec3>& own = pose.positions();
      for (size_t i = 1; i < 4; ++i) {
        EXPECT_NEAR(own[i].z - own[0].z, now[i].z - now[0].z, 5e-5f);
        EXPECT_NEAR(glm::distance(own[i], own[0]), glm::distance(now[i], now[0]), 1e-5f);
      }
    }
  }
}

TEST(ReposePose, DoesNotDependOnThePosesBefore) {
  const std::vector<glm::vec3> last = turned({0.2, 1.0, 0.1}, 0.7, {0.0, 0.0, 1.0});
  ReposePose pose;
  for (const double angle : {0.0, 0.1, 0.2}) {
    const std::vector<glm::vec3> before = turned({1.0, 0.0, 0.0}, angle, {});
    pose.set(kRest, before, 4);
  }
  ReposePose fresh;
  pose.set(kRest, last, 4);
  fresh.set(kRest, last, 4);
  EXPECT_EQ(pose.positions(), fresh.positions());
}

TEST(ReposePose, IsThatOfTheVerticesWhereAnObjectBendsOrIsMirrored) {
  ReposePose pose;
  std::vector<glm::vec3> bent = kRest;
  bent[3].x += 0.001f;
  EXPECT_TRUE(pose.set(kRest, bent, 4));
  EXPECT_EQ(pose.positions(), bent);
  EXPECT_TRUE(pose.set(kRest, bent, 4));
  std::vector<glm::vec3> mirrored = kRest;
  for (glm::vec3& point : mirrored) point.x = -point.x;
  EXPECT_TRUE(pose.set(kRest, mirrored, 4));
  EXPECT_EQ(pose.positions(), mirrored);
  // Without a rest pose, every pose counts as changed.
  EXPECT_TRUE(pose.set({}, kRest, 4));
  EXPECT_TRUE(pose.set({}, kRest, 4));
}

}  // namespace
}  // namespace snowbough::snow
