#include "tree/collars/collars.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "native/tree/collars/built_tubes.h"

namespace snowbough::tree {
namespace {

/// A collar of 16 points around the only child; the base places all in the hole's middle.
Collar collar_of(const BuiltTubes& built) {
  const Fork& fork = built.forks.front();
  const TubePlace middle = built.tubes.nearest(fork.parent_chain, fork.centre, {5.5, 0.0}, 3.0);
  Collar collar(16);
  for (size_t i = 0; i < collar.size(); ++i) {
    collar[i].base = middle;
    collar[i].quarter = 0.25 * static_cast<double>(i);
  }
  return collar;
}

/// Distance from the round limb that leaves the trunk's middle line at 5.5 m.
double from_child(const glm::dvec3& p, const glm::dvec3& direction, double radius) {
  const glm::dvec3 off = p - glm::dvec3(0.0, 0.0, 5.5);
  return glm::length(off - direction * glm::dot(off, direction)) - radius;
}

void expect_collar_on_both(const glm::vec3& direction) {
  const BuiltTubes built(make_skeleton({trunk(0.2f), side_branch(5.5f, 0.1f, direction)}));
  Collar collar = collar_of(built);
  meet_limbs(built.forks.front(), built.tubes, 1.0, collar);
  for (const CollarPoint& point : collar) {
    // The fillet of a limb of 0.1 m is a quarter of that high where both are equally near.
    EXPECT_NEAR(from_child(point.position, glm::normalize(glm::dvec3(direction)), 0.1), 0.025,
                0.005);
    EXPECT_NEAR(std::hypot(point.position.x, point.position.y) - 0.2, 0.035, 0.025);
    EXPECT_LT(glm::distance(built.tubes.at(0, point.target), point.position), 0.065);
  }
}

TEST(Collars, LieWhereALimbMeetsItsParentAtARightAngle) {
  expect_collar_on_both({1.0f, 0.0f, 0.0f});
}

TEST(Collars, LieWhereALimbMeetsItsParentAslant) {
  expect_collar_on_both({0.7f, 0.0f, 0.7f});
}

TEST(Collars, ReachIntoAnAcuteCrotch) {
  const BuiltTubes built(
      make_skeleton({trunk(0.2f), side_branch(5.5f, 0.1f, {0.45f, 0.0f, 0.9f})}));
  Collar collar = collar_of(built);
  meet_limbs(built.forks.front(), built.tubes, 1.0, collar);
  double highest = 0.0;
  for (const CollarPoint& point : collar) highest = std::max(highest, point.position.z);
  // The child's upper side, x = (z - 5.5) / 2 - 0.112, passes x = 0.2 at z = 6.12.
  EXPECT_GT(highest, 6.05);
  EXPECT_LT(highest, 6.45);
}

TEST(Collars, PointsLieEvenlyAlongALongLine) {
  const BuiltTubes built(
      make_skeleton({trunk(0.2f), side_branch(5.5f, 0.1f, {0.3f, 0.0f, 0.95f})}));
  Collar collar = collar_of(built);
  meet_limbs(built.forks.front(), built.tubes, 1.0, collar);
  double shortest = 1e300, longest = 0.0;
  for (size_t i = 0; i < collar.size(); ++i) {
    const double step = glm::distance(collar[i].position, collar[(i + 1) % collar.size()].position);
    shortest = std::min(shortest, step);
    longest = std::max(longest, step);
  }
  EXPECT_LT(longest, 2.0 * shortest);
}

TEST(Collars, PointsKeepTheirTurnsWhereALimbLeavesAtARightAngle) {
  const BuiltTubes built(
      make_skeleton({trunk(0.2f), side_branch(5.5f, 0.05f, {1.0f, 0.0f, 0.0f})}));
  Collar collar = collar_of(built);
  meet_limbs(built.forks.front(), built.tubes, 1.0, collar);
  for (const CollarPoint& point : collar) EXPECT_NEAR(point.turned, 0.0, 0.1);
}

TEST(Collars, StayBelowTheFarthestPlace) {
  const BuiltTubes built(make_skeleton({trunk(0.2f), side_branch(5.5f, 0.1f, {0.3f, 0.0f, 1.0f})}));
  Collar collar = collar_of(built);
  meet_limbs(built.forks.front(), built.tubes, 0.05, collar);
  for (const CollarPoint& point : collar) EXPECT_LE(point.length, 0.05);
}

}  // namespace
}  // namespace snowbough::tree
