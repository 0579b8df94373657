#include <algorithm>
#include <random>
#include <vector>

#include "native/tree/tree_text.h"

namespace snowbough::tree {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// Tubes of triangles, open at both ends, whose rings lose corners; Y up, triangles in random
/// order, vertices in the order in which they are used.
class TriangleTubes {
 public:
  explicit TriangleTubes(uint32_t seed) : random_(seed) {}

  /// @param corners of each ring; the radius falls from `radius` to a quarter of it.
  void tube(glm::vec3 root, glm::vec3 step, float radius, const std::vector<int>& corners) {
    const glm::vec3 side =
        std::abs(step.y) > 0.5f * glm::length(step) ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0);
    const glm::vec3 u = glm::normalize(glm::cross(step, side));
    const glm::vec3 w = glm::normalize(glm::cross(step, u));
    std::vector<glm::vec3> points;
    std::vector<int> ring_begin;
    for (size_t i = 0; i < corners.size(); ++i) {
      ring_begin.push_back(static_cast<int>(points.size()));
      const float along = static_cast<float>(i) / static_cast<float>(corners.size() - 1);
      for (int c = 0; c < corners[i]; ++c) {
        const double angle = 2.0 * M_PI * c / corners[i];
        points.push_back(root + static_cast<float>(i) * step +
                         radius * (1.0f - 0.75f * along) *
                             (static_cast<float>(std::cos(angle)) * u +
                              static_cast<float>(std::sin(angle)) * w));
      }
    }
    std::vector<std::array<int, 3>> triangles;
    for (size_t i = 0; i + 1 < corners.size(); ++i) {
      const int a = corners[i], b = corners[i + 1];
      const auto near = [&](int c) { return ring_begin[i] + c % a; };
      const auto far = [&](int c) { return ring_begin[i + 1] + c % b; };
      for (int p = 0, q = 0; p < a || q < b;) {
        if (q == b || (p < a && (p + 1) * b <= (q + 1) * a)) {
          triangles.push_back({near(p), near(p + 1), far(q)});
          ++p;
        } else {
          triangles.push_back({near(p), far(q + 1), far(q)});
          ++q;
        }
      }
    }
    write(points, triangles);
  }

  std::string text(const std::string& group) const {
    return vertices_.str() + "g " + group + "\n" + faces_.str();
  }

 private:
  void write(const std::vector<glm::vec3>& points, std::vector<std::array<int, 3>>& triangles) {
    for (size_t i = triangles.size() - 1; i > 0; --i) {
      std::swap(triangles[i], triangles[random_() % (i + 1)]);
    }
    std::vector<int> number(points.size(), 0);
    for (const std::array<int, 3>& triangle : triangles) {
      faces_ << "f";
      for (const int v : triangle) {
        if (number[v] == 0) {
          number[v] = ++count_;
          vertices_ << "v " << points[v].x << " " << points[v].y << " " << points[v].z << "\n";
        }
        faces_ << " " << number[v];
      }
      faces_ << "\n";
    }
  }

  std::mt19937 random_;
  std::ostringstream vertices_, faces_;
  int count_ = 0;
};

/// A trunk with a flared root, two limbs, and four twigs on each limb.
TriangleTubes small_tree(uint32_t seed) {
  TriangleTubes tubes(seed);
  tubes.tube({0, 0, 0}, {0, 0.5f, 0}, 0.3f, {24, 24, 20, 16, 13, 10, 8, 6, 5, 4, 4});
  for (const float way : {1.0f, -1.0f}) {
    tubes.tube({0, 2.2f + way, 0}, {0.4f * way, 0.1f, 0}, 0.06f, {6, 5, 4, 3, 3, 3});
    for (int i = 0; i < 4; ++i) {
      const float along = 0.5f + 0.3f * static_cast<float>(i);
      tubes.tube({along * way, 2.2f + way + 0.25f * along, 0}, {0.02f, 0.06f, 0.1f}, 0.012f,
                 {3, 3, 3, 3});
    }
  }
  return tubes;
}

void expect_small_tree(const Skeleton& skeleton) {
  EXPECT_EQ(skeleton.report.form, "MERGED_TUBES");
  EXPECT_EQ(skeleton.report.up_axis, "Y");
  EXPECT_EQ(skeleton.report.foliage_parts, 0);
  EXPECT_THAT(skeleton.report.skipped_parts, IsEmpty());
  EXPECT_THAT(skeleton.report.branches_per_level, ElementsAre(1, 2, 8));
  ASSERT_EQ(skeleton.branches.size(), 11u);
  const Branch& trunk = skeleton.branches[0];
  ASSERT_EQ(trunk.points.size(), 11u);
  EXPECT_LT(glm::distance(trunk.points[0], glm::vec3(0, 0, 0)), 1e-4f);
  EXPECT_LT(glm::distance(trunk.points[10], glm::vec3(0, 0, 5)), 1e-4f);
  EXPECT_NEAR(trunk.radii[0], 0.3f, 1e-4f);
  EXPECT_NEAR(trunk.radii[10], 0.075f, 1e-4f);
  for (size_t b = 3; b < 11; ++b) {
    const Branch& twig = skeleton.branches[b];
    EXPECT_EQ(twig.points.size(), 4u) << b;
    EXPECT_EQ(twig.points[0].x > 0, skeleton.branches[twig.parent].points.back().x > 0) << b;
  }
}

TEST_F(ReadTree, OpenTubesOfTrianglesInAGroupNamedFoliageAreWood) {
  const Skeleton skeleton = read(small_tree(1).text("Foliage01"));
  expect_small_tree(skeleton);
  EXPECT_THAT(
      skeleton.report.warnings,
      ElementsAre("by their names all parts are foliage; wood and leaves were distinguished by "
                  "shape"));
}

TEST_F(ReadTree, OpenTubesOfTrianglesNeedNoNames) {
  const Skeleton skeleton = read(small_tree(2).text("Object05"));
  expect_small_tree(skeleton);
  EXPECT_THAT(skeleton.report.warnings, IsEmpty());
}

TEST_F(ReadTree, NamesOfFoliageDecideIfTheyLeaveWood) {
  TriangleTubes tubes(3);
  tubes.tube({0, 0, 0}, {0, 0.5f, 0}, 0.3f, {8, 7, 6, 5, 4});
  const std::string trunk = tubes.text("trunk");
  const int count = static_cast<int>(std::count(trunk.begin(), trunk.end(), 'v'));
  std::string leaf = "g leaves\nv 0 1 0\nv 0.1 1 0\nv 0 1.1 0\nv 0.5 1.5 0.5\n";
  for (const char* face : {"1 2 4", "2 3 4", "3 1 4"}) {
    std::istringstream corners(face);
    leaf += "f";
    for (int v = 0; corners >> v;) leaf += " " + std::to_string(count + v);
    leaf += "\n";
  }
  const Skeleton skeleton = read(trunk + leaf);
  EXPECT_EQ(skeleton.branches.size(), 1u);
  EXPECT_EQ(skeleton.report.foliage_parts, 1);
}

TEST_F(ReadTree, AFileOfLeavesAloneIsRefusedByItsLeaves) {
  EXPECT_THAT(error_of("g leaves\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n"),
              testing::HasSubstr("only 1 leaves or other loose parts"));
}

TEST_F(ReadTree, ShortTubesOfThreeSidesKeepTheirRingsInAnyOrder) {
  TriangleTubes tubes(4);
  tubes.tube({0, 0, 0}, {0, 0.5f, 0}, 0.3f, {8, 8, 8, 8, 8});
  for (int i = 0; i < 500; ++i) {
    tubes.tube({0, 1.0f + 0.001f * static_cast<float>(i), 0}, {0.3f, 0.01f, 0}, 0.02f,
               {3, 3, 3, 3});
  }
  const Skeleton skeleton = read(tubes.text("tree"));
  ASSERT_EQ(skeleton.branches.size(), 501u);
  for (size_t b = 1; b < 501; ++b) {
    EXPECT_EQ(skeleton.branches[b].points.size(), 4u) << b;
    EXPECT_NEAR(skeleton.branches[b].radii[0], 0.02f, 1e-4f) << b;
  }
}

}  // namespace
}  // namespace snowbough::tree
