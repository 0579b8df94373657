#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <random>

#include "tree/centreline.h"
#include "tree/read_tree.h"
#include "tree/simplify.h"
#include "tree/width.h"

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
  // From (0.15, 0.5) to (0, 3) the kink at (0.3, 1) lies 0.18 away, 0.45 of its radius 0.4.
  Skeleton skeleton = kinked();
  simplify_skeleton(skeleton, Simplify::kTolerance, 0.5f);
  ASSERT_EQ(skeleton.branches[0].points.size(), 4u);
  EXPECT_EQ(skeleton.branches[0].points[3], glm::vec3(0, 0, 4));
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

TEST(Simplify, ToleranceNeverStraysMoreThanItSays) {
  const unsigned seed = 7;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  for (int round = 0; round < 100; ++round) {
    Skeleton skeleton;
    Branch trunk = branch("trunk", 0, -1, {0, 0, 0}, {}, {});
    for (int i = 0; i < 30; ++i) {
      trunk.points.emplace_back(0.1f * unit(random), 0.1f * unit(random), 0.2f * i);
      trunk.radii.push_back(0.15f * (1.0f - i / 29.0f));
      trunk.areas.push_back(trunk.radii.back() * trunk.radii.back());
    }
    skeleton.branches.push_back(trunk);
    for (int c = 0; c < 4; ++c) {
      const size_t i = random() % 29;
      const glm::vec3 at = glm::mix(trunk.points[i], trunk.points[i + 1], unit(random));
      skeleton.branches.push_back(branch("child" + std::to_string(c), 1, 0, at,
                                         {at, at + glm::vec3(1, 0, 0)}, {0.1f, 0.0f}));
    }
    complete_skeleton(skeleton);
    const float tolerance = unit(random);
    simplify_skeleton(skeleton, Simplify::kTolerance, tolerance);
    for (size_t i = 0; i < trunk.points.size(); ++i) {
      const CentrelinePlace place = nearest_place(skeleton.branches[0], trunk.points[i]);
      const float allowed = tolerance * std::max(trunk.radii[i], kSmallestRadius * skeleton.height);
      EXPECT_LE(glm::distance(place.point, trunk.points[i]), allowed + 1e-6f);
    }
  }
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
