#include "tree/skeleton/segment_tree.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <limits>
#include <random>

namespace snowbough::tree {
namespace {

Branch line(std::vector<glm::vec3> points, float radius) {
  Branch branch;
  branch.points = std::move(points);
  branch.radii.assign(branch.points.size(), radius);
  return branch;
}

TEST(SegmentTree, FindsTheNearestOfRandomSegments) {
  constexpr uint32_t kSeed = 7;
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  std::mt19937 random(kSeed);
  const auto unit = [&] { return static_cast<float>(random() * 0x1p-32); };
  const auto place = [&] { return glm::vec3(unit(), unit(), unit()); };
  std::vector<Branch> branches;
  for (int i = 0; i < 60; ++i) {
    branches.push_back(line({place(), place(), place()}, 0.0f));
  }
  const SegmentTree tree(branches, std::vector<int32_t>(branches.size(), 0), 0.0f);
  for (int i = 0; i < 200; ++i) {
    const glm::vec3 point = place();
    double nearest = std::numeric_limits<double>::infinity();
    for (const Branch& branch : branches) {
      for (size_t s = 0; s + 1 < branch.points.size(); ++s) {
        const glm::dvec3 a(branch.points[s]), ab = glm::dvec3(branch.points[s + 1]) - a;
        const double t =
            glm::clamp(glm::dot(glm::dvec3(point) - a, ab) / glm::dot(ab, ab), 0.0, 1.0);
        nearest = std::min(nearest, glm::distance(glm::dvec3(point), a + t * ab));
      }
    }
    EXPECT_NEAR(tree.nearest(point, 1, Measure::kDistance).cost, nearest, 1e-6);
  }
}

TEST(SegmentTree, MeasuresToTheSurfaceOrInRadii) {
  // A thick limb 3 m away with its surface at 1 m, a thin one 2 m away.
  const std::vector<Branch> branches = {line({{3, 0, -5}, {3, 0, 5}}, 2.0f),
                                        line({{-2, 0, -5}, {-2, 0, 5}}, 0.1f)};
  const SegmentTree tree(branches, {0, 0}, 0.0f);
  const glm::vec3 origin(0.0f);
  EXPECT_EQ(tree.nearest(origin, 1, Measure::kDistance).branch, 1);
  EXPECT_EQ(tree.nearest(origin, 1, Measure::kSurface).branch, 0);
  EXPECT_EQ(tree.nearest(origin, 1, Measure::kRadii).branch, 0);
  EXPECT_DOUBLE_EQ(tree.nearest(origin, 1, Measure::kRadii).cost, 1.5);
}

TEST(SegmentTree, FindsTheSameAsAmongEachSegmentAlone) {
  for (const float scale : {1e-4f, 1.0f, 1e5f}) {
    SCOPED_TRACE(testing::Message() << "scale " << scale);
    std::mt19937 random(11);
    // Far from the origin, where floats are coarse.
    const auto unit = [&] { return scale * (30.0f + static_cast<float>(random() * 0x1p-32)); };
    const auto place = [&] { return glm::vec3(unit(), unit(), unit()); };
    std::vector<Branch> branches;
    std::vector<SegmentTree> alone;
    for (int i = 0; i < 100; ++i) {
      const glm::vec3 a = place();
      branches.push_back(line({a, a + 0.1f * (place() - a)}, 0.1f * (unit() - 30.0f * scale)));
      alone.emplace_back(std::vector<Branch>{branches.back()}, std::vector<int32_t>{0}, 0.0f);
    }
    const SegmentTree tree(branches, std::vector<int32_t>(branches.size(), 0), 0.0f);
    for (int i = 0; i < 300; ++i) {
      const glm::vec3 point = place();
      for (const Measure measure : {Measure::kDistance, Measure::kRadii, Measure::kSurface}) {
        NearestSegment best;
        best.cost = std::numeric_limits<double>::infinity();
        for (size_t b = 0; b < alone.size(); ++b) {
          const NearestSegment found = alone[b].nearest(point, 1, measure);
          if (found.cost < best.cost) {
            best = found;
            best.branch = static_cast<int32_t>(b);
          }
        }
        const NearestSegment found = tree.nearest(point, 1, measure);
        ASSERT_EQ(found.branch, best.branch);
        ASSERT_EQ(found.cost, best.cost);
      }
    }
  }
}

TEST(SegmentTree, SeesOnlyWhatMayBeFound) {
  const std::vector<Branch> branches = {line({{1, 0, 0}, {1, 0, 1}}, 0.1f),
                                        line({{2, 0, 0}, {2, 0, 1}}, 0.1f),
                                        line({{3, 0, 0}, {3, 0, 1}}, 0.1f)};
  const SegmentTree tree(branches, {2, 1, 0}, 0.0f);
  const glm::vec3 origin(0.0f);
  EXPECT_EQ(tree.nearest(origin, 3, Measure::kDistance).branch, 0);
  EXPECT_EQ(tree.nearest(origin, 2, Measure::kDistance).branch, 1);
  EXPECT_EQ(tree.nearest(origin, 0, Measure::kDistance).branch, -1);
  const std::vector<char> excluded = {1, 1, 0};
  EXPECT_EQ(tree.nearest(origin, 3, Measure::kDistance, &excluded).branch, 2);
  EXPECT_EQ(tree.nearest(origin, 3, Measure::kDistance, nullptr, 0.5).branch, -1);
}

TEST(SegmentTree, OfEqualsTheFirstIsFoundAndAPointIsASegment) {
  const std::vector<Branch> branches = {line({{0, 1, 0}}, 0.1f), line({{0, -1, 0}}, 0.1f)};
  const NearestSegment found =
      SegmentTree(branches, {0, 0}, 0.0f).nearest(glm::vec3(0.0f), 1, Measure::kDistance);
  EXPECT_EQ(found.branch, 0);
  EXPECT_EQ(found.point, glm::vec3(0, 1, 0));
}

/// A tube of `rings` squares along z, open at both ends.
}  // namespace
}  // namespace snowbough::tree
