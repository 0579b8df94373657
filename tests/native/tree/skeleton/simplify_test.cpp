#include "tree/skeleton/simplify.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "tree/skeleton/centreline.h"
#include "tree/skeleton/width.h"

namespace snowbough::tree {
namespace {

using testing::ElementsAre;
using testing::FloatEq;

Branch branch(std::string name, int32_t level, int32_t parent, glm::vec3 attach,
              std::vector<glm::vec3> points, std::vector<float> radii) {
  Branch b{std::move(name), level, parent, attach, std::move(points), std::move(radii), {}};
  for (const float r : b.radii) b.areas.push_back(std::numbers::pi_v<float> * r * r);
  return b;
}

/// A trunk with a kink at z = 1, children at z = 0.5 and z = 3, and a tip at z = 4.
Skeleton kinked() {
  Skeleton skeleton;
  skeleton.branches.push_back(branch("trunk", 0, -1, {0, 0, 0},
                                     {{0, 0, 0}, {0.3f, 0, 1}, {0, 0, 2}, {0, 0, 4}},
                                     {0.4f, 0.4f, 0.2f, 0.0f}));
  skeleton.branches.push_back(branch("low", 1, 0, {0.15f, 0, 0.5f},
                                     {{0.15f, 0, 0.5f}, {1, 0, 0.6f}, {2, 0, 0.5f}},
                                     {0.1f, 0.1f, 0.0f}));
  skeleton.branches.push_back(
      branch("high", 1, 0, {0, 0, 3}, {{0, 0, 3}, {0, 1, 3}}, {0.1f, 0.0f}));
  complete_skeleton(skeleton);
  return skeleton;
}

TEST(Simplify, NoneKeepsEveryPoint) {
  Skeleton skeleton = kinked();
  simplify_skeleton(skeleton, Simplify::kNone, 0.5f);
  EXPECT_EQ(skeleton.branches[0].points, kinked().branches[0].points);
}

TEST(Simplify, ThesisKeepsRootAndAttachPointsAndEndsAtTheLastChild) {
  Skeleton skeleton = kinked();
  simplify_skeleton(skeleton, Simplify::kThesis, 0.5f);
  const Branch& trunk = skeleton.branches[0];
  ASSERT_EQ(trunk.points.size(), 3u);
  EXPECT_EQ(trunk.points[0], glm::vec3(0, 0, 0));
  EXPECT_NEAR(glm::distance(trunk.points[1], glm::vec3(0.15f, 0, 0.5f)), 0.0f, 1e-6f);
  EXPECT_EQ(trunk.points[2], glm::vec3(0, 0, 3));
}

TEST(Simplify, ThesisInterpolatesRadiusAndAreaAtAttachPoints) {
  Skeleton skeleton = kinked();
  simplify_skeleton(skeleton, Simplify::kThesis, 0.5f);
  EXPECT_FLOAT_EQ(skeleton.branches[0].radii[1], 0.4f);
  EXPECT_FLOAT_EQ(skeleton.branches[0].radii[2], 0.1f);
  EXPECT_NEAR(skeleton.branches[0].areas[2], std::numbers::pi_v<float> * 0.01f, 1e-6f);
}

TEST(Simplify, ThesisKeepsEveryPointOfABranchWithoutChildren) {
  Skeleton skeleton = kinked();
  simplify_skeleton(skeleton, Simplify::kThesis, 0.5f);
  EXPECT_EQ(skeleton.branches[1].points.size(), 3u);
}

TEST(Simplify, AttachPointsArePointsOfTheParentAfterwards) {
  Skeleton skeleton = kinked();
  simplify_skeleton(skeleton, Simplify::kTolerance, 0.5f);
  for (size_t b = 1; b < skeleton.branches.size(); ++b) {
    const std::vector<glm::vec3>& points = skeleton.branches[0].points;
    EXPECT_NE(std::find(points.begin(), points.end(), skeleton.branches[b].attach_point),
              points.end());
  }
}

TEST(Simplify, ThesisKeepsTheTipWhenAllChildrenSitAtTheRoot) {
  Skeleton skeleton = kinked();
  for (size_t b = 1; b < skeleton.branches.size(); ++b) {
    skeleton.branches[b].attach_point = {0, 0, 0};
  }
  simplify_skeleton(skeleton, Simplify::kThesis, 0.5f);
  EXPECT_THAT(skeleton.branches[0].points, ElementsAre(glm::vec3(0, 0, 0), glm::vec3(0, 0, 4)));
}

TEST(Simplify, ChildrenAtOnePlaceShareAPoint) {
  Skeleton skeleton = kinked();
  skeleton.branches[1].attach_point = {0, 0, 3};
  simplify_skeleton(skeleton, Simplify::kThesis, 0.5f);
  EXPECT_THAT(skeleton.branches[0].points, ElementsAre(glm::vec3(0, 0, 0), glm::vec3(0, 0, 3)));
}

TEST(Simplify, AChildAtAPointOfTheParentAddsNone) {
  Skeleton skeleton = kinked();
  skeleton.branches[1].attach_point = {0.3f, 0, 1};
  skeleton.branches[2].attach_point = {0, 0, 4};
  simplify_skeleton(skeleton, Simplify::kThesis, 0.5f);
  EXPECT_THAT(skeleton.branches[0].points,
              ElementsAre(glm::vec3(0, 0, 0), glm::vec3(0.3f, 0, 1), glm::vec3(0, 0, 4)));
}

TEST(Simplify, ToleranceDropsAKinkWithinItAndKeepsTheTip) {
  // From (0.15, 0.5) to (0, 3) the kink at (0.3, 1) lies 0.180 away, and the cone there is 0.341
  // thick instead of 0.4: 0.239 in all, 0.597 of its radius.
  Skeleton skeleton = kinked();
  simplify_skeleton(skeleton, Simplify::kTolerance, 0.6f);
  ASSERT_EQ(skeleton.branches[0].points.size(), 4u);
  EXPECT_EQ(skeleton.branches[0].points[3], glm::vec3(0, 0, 4));
}

/// A straight trunk of 10 m with a flare at its foot, and a child at its end.
Skeleton flared() {
  Skeleton skeleton;
  skeleton.branches.push_back(branch("trunk", 0, -1, {0, 0, 0},
                                     {{0, 0, 0}, {0, 0, 1}, {0, 0, 5}, {0, 0, 10}},
                                     {1.0f, 0.4f, 0.4f, 0.4f}));
  skeleton.branches.push_back(
      branch("child", 1, 0, {0, 0, 10}, {{0, 0, 10}, {1, 0, 10}}, {0.1f, 0.0f}));
  complete_skeleton(skeleton);
  return skeleton;
}

TEST(Simplify, ToleranceKeepsAFlareOfAStraightLimb) {
  // The cone from foot to end is 0.94 thick 1 m up: 0.54 too much, 1.35 of the radius there.
  Skeleton skeleton = flared();
  simplify_skeleton(skeleton, Simplify::kTolerance, 1.3f);
  EXPECT_THAT(skeleton.branches[0].points,
              ElementsAre(glm::vec3(0, 0, 0), glm::vec3(0, 0, 1), glm::vec3(0, 0, 10)));
  EXPECT_THAT(skeleton.branches[0].radii, ElementsAre(1.0f, 0.4f, 0.4f));
  skeleton = flared();
  simplify_skeleton(skeleton, Simplify::kTolerance, 1.4f);
  EXPECT_EQ(skeleton.branches[0].points.size(), 2u);
}

TEST(Simplify, ToleranceKeepsThePalmsRingsAndNotUnevenBark) {
  // A straight trunk whose rings are alternately thicker by a part of their radius.
  for (const auto& [bulge, kept] : {std::pair(0.05f, 20u), {0.02f, 2u}}) {
    Skeleton skeleton = flared();
    Branch& trunk = skeleton.branches[0];
    trunk = branch("trunk", 0, -1, {0, 0, 0}, {}, {});
    for (int i = 0; i < 20; ++i) {
      trunk.points.emplace_back(0, 0, 0.1f * static_cast<float>(i));
      trunk.radii.push_back(i % 2 == 0 ? 0.2f : 0.2f * (1.0f + bulge));
      trunk.areas.push_back(std::numbers::pi_v<float> * trunk.radii[i] * trunk.radii[i]);
    }
    skeleton.branches[1].attach_point = trunk.points.back();
    const std::vector<glm::vec3> before = trunk.points;
    simplify_skeleton(skeleton, Simplify::kTolerance, 0.5f);
    EXPECT_EQ(skeleton.branches[0].points.size(), kept) << bulge;
    if (kept == before.size()) {
      EXPECT_EQ(skeleton.branches[0].points, before);
    }
  }
}

TEST(Simplify, ToleranceKeepsWoodThatOnlyTheAreasTell) {
  // The same radii throughout, but a ring of sixteen times the wood: the cone's circle there has
  // radius 0.4, the ring's own 1.6.
  Skeleton skeleton = flared();
  skeleton.branches[0].radii[0] = 0.4f;
  skeleton.branches[0].areas[0] = skeleton.branches[0].areas[1];
  skeleton.branches[0].areas[2] *= 16.0f;
  simplify_skeleton(skeleton, Simplify::kTolerance, 2.9f);
  EXPECT_THAT(skeleton.branches[0].points,
              ElementsAre(glm::vec3(0, 0, 0), glm::vec3(0, 0, 5), glm::vec3(0, 0, 10)));
}

TEST(Simplify, ToleranceCountsWhereALimbReachesBackBehindItsBone) {
  // The limb sets out backwards to x = -0.3 and returns: 0.3 behind the bone's root, 1.5 radii.
  for (const float tolerance : {1.4f, 1.6f}) {
    Skeleton skeleton = flared();
    skeleton.branches[0].points = {{0, 0, 0}, {-0.3f, 0, 0}, {5, 0, 0}, {10, 0, 0}};
    skeleton.branches[0].radii = {0.2f, 0.2f, 0.2f, 0.2f};
    skeleton.branches[0].areas = std::vector<float>(4, std::numbers::pi_v<float> * 0.04f);
    skeleton.branches[1].attach_point = {10, 0, 0};
    simplify_skeleton(skeleton, Simplify::kTolerance, tolerance);
    EXPECT_EQ(skeleton.branches[0].points.size(), tolerance < 1.5f ? 3u : 2u);
  }
}

TEST(Simplify, ToleranceKeepsAKinkBeyondIt) {
  Skeleton skeleton = kinked();
  simplify_skeleton(skeleton, Simplify::kTolerance, 0.4f);
  const std::vector<glm::vec3>& points = skeleton.branches[0].points;
  EXPECT_NE(std::find(points.begin(), points.end(), glm::vec3(0.3f, 0, 1)), points.end());
}

TEST(Simplify, RejectsANegativeOrEndlessTolerance) {
  Skeleton skeleton = kinked();
  EXPECT_THROW(simplify_skeleton(skeleton, Simplify::kTolerance, -1.0f), std::invalid_argument);
  EXPECT_THROW(
      simplify_skeleton(skeleton, Simplify::kTolerance, std::numeric_limits<float>::infinity()),
      std::invalid_argument);
}

/// How far a point stands out of a limb of `factor` times the radii: of the balls that sweep along
/// it, the distance from the nearest one.
float outside(const Branch& limb, const glm::vec3& p, float factor) {
  float best = std::numeric_limits<float>::max();
  for (size_t i = 0; i + 1 < limb.points.size(); ++i) {
    const auto from_ball = [&](float t) {
      return glm::distance(p, glm::mix(limb.points[i], limb.points[i + 1], t)) -
             factor * (limb.radii[i] + (limb.radii[i + 1] - limb.radii[i]) * t);
    };
    // Convex along the segment.
    float low = 0.0f, high = 1.0f;
    for (int step = 0; step < 40; ++step) {
      const float a = low + (high - low) / 3.0f, b = high - (high - low) / 3.0f;
      (from_ball(a) < from_ball(b) ? high : low) = from_ball(a) < from_ball(b) ? b : a;
    }
    best = std::min(best, from_ball(0.5f * (low + high)));
  }
  return best;
}

/// Points all over the limb's surface, each with the radius there.
std::vector<std::pair<glm::vec3, float>> surface_points(const Branch& limb) {
  std::vector<std::pair<glm::vec3, float>> points;
  for (size_t i = 0; i + 1 < limb.points.size(); ++i) {
    const glm::vec3 axis = limb.points[i + 1] - limb.points[i];
    const glm::vec3 u = glm::normalize(glm::cross(axis, glm::vec3(0.3f, 1.0f, 0.2f)));
    const glm::vec3 v = glm::normalize(glm::cross(axis, u));
    for (const float t : {0.0f, 0.2f, 0.4f, 0.6f, 0.8f, 1.0f}) {
      const float radius = limb.radii[i] + (limb.radii[i + 1] - limb.radii[i]) * t;
      for (const float angle : {0.0f, 1.0f, 2.0f, 3.0f, 4.0f, 5.0f}) {
        points.emplace_back(
            limb.points[i] + axis * t + radius * (std::cos(angle) * u + std::sin(angle) * v),
            radius);
      }
    }
  }
  return points;
}

TEST(Simplify, ToleranceNeverStraysMoreThanItSays) {
  int dropped = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    Skeleton skeleton;
    Branch trunk = branch("trunk", 0, -1, {0, 0, 0}, {}, {});
    const float wander = 0.2f * unit(random), flare = 3.0f * unit(random);
    for (int i = 0; i < 20; ++i) {
      trunk.points.emplace_back(wander * unit(random), wander * unit(random), 0.2f * i);
      trunk.radii.push_back(0.15f * (1.0f - i / 19.0f) * (1.0f + flare * std::exp(-0.8f * i)) *
                            (1.0f + 0.2f * unit(random)));
      trunk.areas.push_back(std::numbers::pi_v<float> * trunk.radii.back() * trunk.radii.back());
    }
    skeleton.branches.push_back(trunk);
    for (int c = 0; c < 2; ++c) {
      const size_t i = random() % 19;
      const glm::vec3 at = glm::mix(trunk.points[i], trunk.points[i + 1], unit(random));
      skeleton.branches.push_back(branch("child" + std::to_string(c), 1, 0, at,
                                         {at, at + glm::vec3(1, 0, 0)}, {0.1f, 0.0f}));
    }
    complete_skeleton(skeleton);
    const float tolerance = 0.1f + unit(random);
    simplify_skeleton(skeleton, Simplify::kTolerance, tolerance);
    dropped += skeleton.branches[0].points.size() < trunk.points.size() ? 1 : 0;

    // Either limb's surface lies in the other one, but for the tolerance times the old radius.
    const Branch& after = skeleton.branches[0];
    const float smallest = kSmallestRadius * skeleton.height;
    const float slack = tolerance * smallest + 2e-5f;
    float out_of_new = 0.0f, out_of_old = 0.0f;
    for (const auto& [p, radius] : surface_points(trunk)) {
      out_of_new = std::max(out_of_new, outside(after, p, 1.0f) - tolerance * radius);
    }
    for (const auto& [p, radius] : surface_points(after)) {
      out_of_old = std::max(out_of_old, outside(trunk, p, 1.0f + tolerance));
    }
    EXPECT_LE(out_of_new, slack);
    EXPECT_LE(out_of_old, slack);
    for (size_t i = 0; i < trunk.points.size(); ++i) {
      const CentrelinePlace place = nearest_place(skeleton.branches[0], trunk.points[i]);
      const float allowed = tolerance * std::max(trunk.radii[i], smallest);
      EXPECT_LE(glm::distance(place.point, trunk.points[i]), allowed + 1e-6f);
    }
  }
  EXPECT_GT(dropped, 30);
}

TEST(Width, OriginalKeepsTheExportsRadiiAndAreas) {
  const Widths widths = limb_widths(kinked(), {});
  EXPECT_THAT(widths.radii[0], ElementsAre(0.4f, 0.4f, 0.2f, 4.0f * 2e-5f));
  EXPECT_FLOAT_EQ(widths.areas[0][2], std::numbers::pi_v<float> * 0.04f);
}

TEST(Width, NoRadiusIsSmallerThanAShareOfTheHeight) {
  const Skeleton skeleton = kinked();
  for (const WidthMode mode : {WidthMode::kOriginal, WidthMode::kInverse}) {
    const Widths widths = limb_widths(skeleton, {.mode = mode});
    for (const auto& radii : widths.radii) {
      for (const float radius : radii) EXPECT_GE(radius, 8e-5f);
    }
    for (const auto& areas : widths.areas) {
      for (const float area : areas) EXPECT_GE(std::sqrt(area / std::numbers::pi), 7.99e-5);
    }
  }
}

TEST(Width, InverseIsTheRootsWidthAtTheRootAndNothingAtTheTip) {
  EXPECT_FLOAT_EQ(inverse_width(0.3f, 0.0f, 4.0f), 0.3f);
  EXPECT_FLOAT_EQ(inverse_width(0.3f, 1.0f, 4.0f), 0.0f);
}

TEST(Width, InverseAtHalfTheLength) {
  // X = 4: (1 / 2.5 - 1/4) / (3/4) = 0.2. X = 16: (1 / 8.5 - 1/16) / (15/16) = 0.0588235.
  EXPECT_FLOAT_EQ(inverse_width(1.0f, 0.5f, 4.0f), 0.2f);
  EXPECT_FLOAT_EQ(inverse_width(1.0f, 0.5f, 16.0f), 1.0f / 17.0f);
}

/// A straight trunk 4 m high, a branch at half its height, a twig at a quarter of the branch.
Skeleton straight() {
  Skeleton skeleton;
  skeleton.branches.push_back(
      branch("trunk", 0, -1, {0, 0, 0}, {{0, 0, 0}, {0, 0, 2}, {0, 0, 4}}, {0.5f, 0.4f, 0.0f}));
  skeleton.branches.push_back(
      branch("branch", 1, 0, {0, 0, 2}, {{0, 0, 2}, {1, 0, 2}, {2, 0, 2}}, {0.2f, 0.1f, 0.0f}));
  skeleton.branches.push_back(
      branch("twig", 2, 1, {0.5f, 0, 2}, {{0.5f, 0, 2}, {0.5f, 1, 2}}, {0.05f, 0.0f}));
  complete_skeleton(skeleton);
  return skeleton;
}

TEST(Width, InverseTakesTheParentsWidthAtTheAttachPoint) {
  const Widths widths = limb_widths(straight(), {.mode = WidthMode::kInverse});
  EXPECT_THAT(widths.radii[0], ElementsAre(FloatEq(0.5f), FloatEq(0.1f), FloatEq(8e-5f)));
  EXPECT_THAT(widths.radii[1], ElementsAre(FloatEq(0.1f), FloatEq(0.02f), FloatEq(8e-5f)));
  // (1 / 1.75 - 1/4) / (3/4) = 3/7 of the branch's root width.
  EXPECT_FLOAT_EQ(widths.radii[2][0], 0.1f * 3.0f / 7.0f);
}

TEST(Width, InverseAreasAreCircles) {
  const Widths widths = limb_widths(straight(), {.mode = WidthMode::kInverse});
  EXPECT_FLOAT_EQ(widths.areas[0][1], std::numbers::pi_v<float> * 0.01f);
}

TEST(Width, EvergreensFirstLevelHasTheLargerBound) {
  const Widths widths =
      limb_widths(straight(), {.mode = WidthMode::kInverse, .species = Species::kEvergreen});
  EXPECT_FLOAT_EQ(widths.radii[0][1], 0.1f);
  EXPECT_FLOAT_EQ(widths.radii[1][1], 0.1f / 17.0f);
  // (1 / 4.75 - 1/16) / (15/16) = 3/19: the trunk and the twigs keep the normal bound.
  EXPECT_FLOAT_EQ(widths.radii[2][0], 0.1f * 3.0f / 19.0f);
}

TEST(Width, ARootOfNoThicknessTakesTheLimbsLargestRadius) {
  Skeleton skeleton = straight();
  skeleton.branches[0].radii[0] = 0.0f;
  const Widths widths = limb_widths(skeleton, {.mode = WidthMode::kInverse});
  EXPECT_FLOAT_EQ(widths.radii[0][0], 0.4f);
}

TEST(Width, RejectsABoundThatIsNotMoreThanOne) {
  EXPECT_THROW(limb_widths(straight(), {.mode = WidthMode::kInverse, .bound = 1.0f}),
               std::invalid_argument);
}

}  // namespace
}  // namespace snowbough::tree
