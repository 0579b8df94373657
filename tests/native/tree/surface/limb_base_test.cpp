#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "native/tree/built_surface.h"
#include "tree/build_tree_mesh.h"

namespace snowbough::tree {
namespace {

using testing::SizeIs;

TEST(Surface, TheChildsOwnJointsInsideTheParentAreDropped) {
  const Branch child =
      make_branch(0, 1, {{0, 0, 5.5f}, {0.05f, 0, 5.5f}, {0.1f, 0, 5.5f}, {1, 0, 5.5f}},
                  {0.05f, 0.05f, 0.05f, 0.05f});
  const Built built = build(make_skeleton({trunk(), child}));
  EXPECT_THAT(built.surface.limbs[1].rings, SizeIs(2));
}

/// The least mean height of a branch's walls and insets, in longest edges of the same face.
double thinnest_face(const Surface& surface, int32_t branch) {
  double thinnest = 1.0;
  for (size_t f = 0; f < surface.quads.size(); ++f) {
    if (surface.origins[f].branch != branch) continue;
    std::array<glm::dvec3, 4> p;
    for (int k = 0; k < 4; ++k) p[k] = surface.vertices[surface.quads[f][k]];
    double longest = 0.0;
    for (int k = 0; k < 4; ++k) longest = std::max(longest, glm::distance(p[k], p[(k + 1) % 4]));
    const double area = 0.5 * glm::length(glm::cross(p[2] - p[0], p[3] - p[1]));
    thinnest = std::min(thinnest, area / (longest * longest));
  }
  return thinnest;
}

TEST(Surface, NoSliverLiesAcrossALimbBesideAHole) {
  // Slivers show as dark lines round the limb once it is shaded smooth. The steeper the branch, the
  // further its hole moves towards the knuckle's end.
  for (const float up : {-2.0f, -0.5f, 0.0f, 0.5f, 2.0f}) {
    SCOPED_TRACE("up " + std::to_string(up));
    const glm::vec3 direction = glm::normalize(glm::vec3(1.0f, 0.0f, up));
    EXPECT_GT(thinnest_face(
                  build(make_skeleton({trunk(), side_branch(5.5f, 0.05f, direction)})).surface, 0),
              0.04);
  }
}

/// Width of the second limb's base after narrowing steps, relative to none.
double narrowed_width(float radius, uint8_t steps) {
  const Skeleton skeleton = make_skeleton({trunk(), side_branch(5.5f, radius)});
  const LengthLimits scale = length_limits(skeleton);
  const std::vector<LimbPath> paths = limb_paths(skeleton, limb_widths(skeleton, {}), scale);
  const auto width = [&](uint8_t of) {
    const Surface surface = build_surface(skeleton, paths, scale, {}, {0, of});
    const auto& hole = surface.limbs[1].rings[0].vertices;
    return glm::distance(surface.vertices[hole[0]], surface.vertices[hole[2]]);
  };
  return width(steps) / width(0);
}

TEST(Surface, OfNarrowedLimbsThickOnesKeepHalfTheirWidth) {
  EXPECT_NEAR(narrowed_width(0.12f, 1), 0.7, 0.05);
  EXPECT_NEAR(narrowed_width(0.12f, 6), 0.5, 0.05);
  EXPECT_LT(narrowed_width(0.02f, 6), 0.2);
}

/// `count` branches as thick as their parent, one above the other on half a metre of it.
Skeleton crowd(int count) {
  std::vector<Branch> branches = {make_branch(-1, 0, {{0, 0, 5}, {0, 0, 5.5f}}, {0.2f, 0.2f})};
  for (int i = 0; i < count; ++i) {
    branches.push_back(side_branch(5.25f + 0.01f * static_cast<float>(i), 0.2f));
  }
  return make_skeleton(branches);
}

TEST(Surface, BranchesWithoutRoomOnTheirParentAreReportedWithTheirNames) {
  EXPECT_THAT(build(crowd(5)).surface.squeezed, testing::UnorderedElementsAre(1, 2, 3, 4, 5));
  EXPECT_THAT(
      build_tree_mesh(crowd(5)).warnings,
      testing::Contains("5 branches have a shortened base because their parent lacks room: b1, "
                        "b2, b3 and 2 more"));
}

TEST(Surface, ABranchWithRoomForItsWholeWidthIsNotReportedAsSqueezed) {
  EXPECT_THAT(build(crowd(1)).surface.squeezed, testing::IsEmpty());
  EXPECT_THAT(build(make_skeleton({trunk(), side_branch(5.5f, 0.05f)})).surface.squeezed,
              testing::IsEmpty());
}

/// The least angle, in degrees, at which the corners of a branch's second ring stand over the plane
/// of its hole, seen from the hole's edge; corners straight over the hole do not count.
double least_rise(const Surface& surface, int32_t branch) {
  std::array<glm::dvec3, 4> hole;
  for (int k = 0; k < 4; ++k) {
    hole[k] = surface.vertices[surface.limbs[branch].rings[0].vertices[k]];
  }
  const glm::dvec3 normal = glm::normalize(glm::cross(hole[2] - hole[0], hole[3] - hole[1]));
  double least = 90.0;
  for (const int32_t v : surface.limbs[branch].rings[1].vertices) {
    const glm::dvec3 p = surface.vertices[v];
    double beyond = 0.0;
    for (int k = 0; k < 4; ++k) {
      const glm::dvec3 outward = glm::normalize(glm::cross(hole[(k + 1) % 4] - hole[k], normal));
      beyond = std::max(beyond, glm::dot(p - hole[k], outward));
    }
    if (beyond > 0.0) {
      const double height = glm::dot(p - hole[0], normal);
      least = std::min(least, std::atan2(height, beyond) * 180.0 / M_PI);
    }
  }
  return least;
}

/// A branch that leaves over an edge of the square trunk, 35 degrees from the side that it leaves.
Branch aslant_branch(double step) {
  std::vector<glm::vec3> points;
  for (int i = 0; i <= 12; ++i) {
    const auto along = static_cast<float>(step * i);
    points.push_back(glm::vec3(0, 0, 5.5f) + glm::normalize(glm::vec3(1, 1, 1)) * along);
  }
  return make_branch(0, 1, points, std::vector<float>(points.size(), 0.1f));
}

TEST(Surface, ABranchAslantDoesNotHangOverItsParentsSideWithASlitUnderIt) {
  for (const double step : {0.1, 0.15, 0.2, 0.27, 0.3, 0.35, 0.5}) {
    SCOPED_TRACE("step " + std::to_string(step));
    EXPECT_GT(least_rise(build(make_skeleton({trunk(), aslant_branch(step)})).surface, 1), 12.0);
  }
}

TEST(Surface, AKnuckleAtABranchsBaseDoesNotHangOverTheParentsSideEither) {
  const Branch aslant = aslant_branch(0.5);
  const glm::vec3 root = aslant.points[0] + glm::normalize(glm::vec3(1, 1, 1)) * 0.3f;
  const Branch twig = make_branch(1, 2, {root, root + glm::vec3(1, -1, 0)}, {0.03f, 0.03f});
  const Surface surface = build(make_skeleton({trunk(), aslant, twig})).surface;
  ASSERT_EQ(surface.junctions[1].row, 1) << "the twig's knuckle comes first on its branch";
  EXPECT_GT(least_rise(surface, 1), 12.0);
}

TEST(Surface, AHoleNearASidesEdgeLeavesRoomForHalfAnotherBesideIt) {
  const Surface surface = build(make_skeleton({trunk(), aslant_branch(0.5)})).surface;
  const Junction& junction = surface.junctions[0];
  const auto& low = surface.limbs[0].rings[junction.row].vertices;
  const auto& hole = surface.limbs[1].rings[0].vertices;
  const double width = glm::distance(surface.vertices[hole[0]], surface.vertices[hole[1]]);
  const glm::dvec3 from = surface.vertices[low[junction.side]];
  const glm::dvec3 to = surface.vertices[low[(junction.side + 1) % 4]];
  const glm::dvec3 across = glm::normalize(to - from);
  EXPECT_GT(glm::dot(surface.vertices[hole[0]] - from, across), 0.3 * width);
  EXPECT_GT(glm::dot(to - surface.vertices[hole[1]], across), 0.3 * width);
}

TEST(Surface, AJointCloseToAKnuckleLosesItsRing) {
  for (const float height : {5.13f, 5.15f, 5.17f, 5.2f, 5.25f, 5.3f}) {
    SCOPED_TRACE("height " + std::to_string(height));
    EXPECT_GT(thinnest_face(build(make_skeleton({trunk(), side_branch(height, 0.05f)})).surface, 0),
              0.04);
  }
}

}  // namespace
}  // namespace snowbough::tree
