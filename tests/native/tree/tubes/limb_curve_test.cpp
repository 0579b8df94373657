#include "tree/tubes/limb_curve.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace snowbough::tree {
namespace {

LimbPath path_of(std::vector<glm::dvec3> points, std::vector<double> corners) {
  LimbPath path;
  path.points = std::move(points);
  path.corners = std::move(corners);
  measure(path);
  path.bone_lengths = path.lengths;
  return path;
}

const glm::dvec3 kEnds(0.0);

TEST(LimbCurve, PassesThroughItsJointsWithTheirThickness) {
  const LimbPath path = path_of({{0, 0, 0}, {0, 0, 1}, {0.4, 0, 2}, {0.4, 0.5, 3}}, {4, 3, 2, 1});
  const LimbCurve curve(path, kEnds, kEnds, 5e-3);
  for (size_t i = 0; i < path.points.size(); ++i) {
    EXPECT_LT(glm::distance(curve.position(path.lengths[i]), path.points[i]), 1e-9);
    EXPECT_NEAR(curve.corner(path.lengths[i]), path.corners[i], 1e-9);
  }
}

TEST(LimbCurve, HasNoKinkAtAJoint) {
  const LimbPath path = path_of({{0, 0, 0}, {0, 0, 1}, {0.5, 0, 2}}, {0.1, 0.1, 0.1});
  const LimbCurve curve(path, kEnds, kEnds, 5e-3);
  const double s = path.lengths[1], step = 1e-5;
  const glm::dvec3 before = glm::normalize(curve.position(s) - curve.position(s - step));
  const glm::dvec3 after = glm::normalize(curve.position(s + step) - curve.position(s));
  EXPECT_GT(glm::dot(before, after), 1.0 - 1e-6);
}

TEST(LimbCurve, AThickLimbStaysCloseToItsStraightSegments) {
  const double corner = 0.3;
  const LimbPath path = path_of({{0, 0, 0}, {0, 0, 4}, {3, 0, 7}}, {corner, corner, corner});
  const LimbCurve curve(path, kEnds, kEnds, 5e-3);
  for (double s = 0.0; s < path.length(); s += 0.05) {
    EXPECT_LT(glm::distance(curve.position(s), position_at(path, s)), 0.08 * corner);
  }
}

TEST(LimbCurve, ASharpJointIsNotTighterThanTheLimbIsThick) {
  const double corner = 0.05;
  const LimbPath path = path_of({{0, 0, 0}, {0, 0, 1}, {1, 0, 1}}, {corner, corner, corner});
  const LimbCurve curve(path, kEnds, kEnds, 0.0);
  const double step = 1e-3;
  for (double s = 1.0 + step; s < 1.2; s += step) {
    const glm::dvec3 before = curve.position(s) - curve.position(s - step);
    const glm::dvec3 after = curve.position(s + step) - curve.position(s);
    const double turn = std::atan2(glm::length(glm::cross(before, after)), glm::dot(before, after));
    EXPECT_LT(turn / glm::length(after), 1.1 / corner) << s;
  }
}

TEST(LimbCurve, AThinLimbStraysNoFurtherThanItMay) {
  const LimbPath path = path_of({{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 2}}, {0, 0, 0, 0});
  for (const double thin_stray : {5e-3, 2e-2}) {
    const LimbCurve curve(path, kEnds, kEnds, thin_stray);
    double farthest = 0.0;
    for (double s = 0.0; s < path.length(); s += 1e-3) {
      farthest = std::max(farthest, glm::distance(curve.position(s), position_at(path, s)));
    }
    EXPECT_GT(farthest, 0.5 * thin_stray);
    EXPECT_LT(farthest, 1.1 * thin_stray);
  }
}

TEST(LimbCurve, ThicknessNeverOvershootsItsJoints) {
  const LimbPath path = path_of({{0, 0, 0}, {0, 0, 1}, {0, 0, 2}, {0, 0, 3}}, {1.0, 0.9, 0.1, 0.1});
  const LimbCurve curve(path, kEnds, kEnds, 5e-3);
  double last = 1.0;
  for (double s = 0.0; s <= 3.0; s += 0.01) {
    EXPECT_LE(curve.corner(s), last + 1e-12);
    EXPECT_GE(curve.corner(s), 0.1 - 1e-12);
    last = curve.corner(s);
  }
}

}  // namespace
}  // namespace snowbough::tree
