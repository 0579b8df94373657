#include "tree/rims/rims.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "native/tree/rims/built_tubes.h"

namespace snowbough::tree {
namespace {

/// A rim of 16 points around the only child; the base places all in the hole's middle.
Rim rim_of(const BuiltTubes& built) {
  const Fork& fork = built.forks.front();
  const TubePlace middle = built.tubes.nearest(fork.parent_chain, fork.centre, {5.5, 0.0}, 3.0);
  Rim rim(16);
  for (size_t i = 0; i < rim.size(); ++i) {
    rim[i].base = middle;
    rim[i].quarter = 0.25 * static_cast<double>(i);
  }
  return rim;
}

/// Distance from the round limb that leaves the trunk's middle line at 5.5 m.
double from_child(const glm::dvec3& p, const glm::dvec3& direction, double radius) {
  const glm::dvec3 off = p - glm::dvec3(0.0, 0.0, 5.5);
  return glm::length(off - direction * glm::dot(off, direction)) - radius;
}

void expect_rim_on_both(const glm::vec3& direction) {
  const BuiltTubes built(make_skeleton({trunk(0.2f), side_branch(5.5f, 0.1f, direction)}));
  Rim rim = rim_of(built);
  meet_limbs(built.forks.front(), built.tubes, 1.0, rim);
  for (const RimPoint& point : rim) {
    // The fillet of a limb of 0.1 m is a quarter of that high where both are equally near.
    EXPECT_NEAR(from_child(point.position, glm::normalize(glm::dvec3(direction)), 0.1), 0.025,
                0.005);
    EXPECT_NEAR(std::hypot(point.position.x, point.position.y) - 0.2, 0.035, 0.025);
    EXPECT_LT(glm::distance(built.tubes.at(0, point.target), point.position), 0.065);
  }
}

TEST(Rims, LieWhereALimbMeetsItsParentAtARightAngle) {
  expect_rim_on_both({1.0f, 0.0f, 0.0f});
}

TEST(Rims, LieWhereALimbMeetsItsParentAslant) {
  expect_rim_on_both({0.7f, 0.0f, 0.7f});
}

TEST(Rims, ReachIntoAnAcuteCrotch) {
  const BuiltTubes built(
      make_skeleton({trunk(0.2f), side_branch(5.5f, 0.1f, {0.45f, 0.0f, 0.9f})}));
  Rim rim = rim_of(built);
  meet_limbs(built.forks.front(), built.tubes, 1.0, rim);
  double highest = 0.0;
  for (const RimPoint& point : rim) highest = std::max(highest, point.position.z);
  // The child's upper side, x = (z - 5.5) / 2 - 0.112, passes x = 0.2 at z = 6.12.
  EXPECT_GT(highest, 6.05);
  EXPECT_LT(highest, 6.45);
}

TEST(Rims, PointsLieEvenlyAlongALongLine) {
  const BuiltTubes built(
      make_skeleton({trunk(0.2f), side_branch(5.5f, 0.1f, {0.3f, 0.0f, 0.95f})}));
  Rim rim = rim_of(built);
  meet_limbs(built.forks.front(), built.tubes, 1.0, rim);
  double shortest = 1e300, longest = 0.0;
  for (size_t i = 0; i < rim.size(); ++i) {
    const double step = glm::distance(rim[i].position, rim[(i + 1) % rim.size()].position);
    shortest = std::min(shortest, step);
    longest = std::max(longest, step);
  }
  EXPECT_LT(longest, 2.0 * shortest);
}

TEST(Rims, PointsKeepTheirTurnsWhereALimbLeavesAtARightAngle) {
  const BuiltTubes built(
      make_skeleton({trunk(0.2f), side_branch(5.5f, 0.05f, {1.0f, 0.0f, 0.0f})}));
  Rim rim = rim_of(built);
  meet_limbs(built.forks.front(), built.tubes, 1.0, rim);
  for (const RimPoint& point : rim) EXPECT_NEAR(point.turned, 0.0, 0.1);
}

TEST(Rims, StayBelowTheFarthestPlace) {
  const BuiltTubes built(make_skeleton({trunk(0.2f), side_branch(5.5f, 0.1f, {0.3f, 0.0f, 1.0f})}));
  Rim rim = rim_of(built);
  meet_limbs(built.forks.front(), built.tubes, 0.05, rim);
  for (const RimPoint& point : rim) EXPECT_LE(point.length, 0.05);
}

}  // namespace
}  // namespace snowbough::tree
