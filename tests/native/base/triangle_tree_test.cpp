#include "base/triangle_tree.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <iostream>
#include <random>

namespace snowbough::base {
namespace {

/// Two level triangles over each other, each a group, and a group without any.
TriangleTree two_levels() {
  return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 2}, {1, 0, 2}, {0, 1, 2}},
          {{0, 1, 2}, {3, 4, 5}},
          {0, 1, 2, 2}};
}

TEST(DistanceAlong, IsThatToTheTriangleFromEitherSide) {
  EXPECT_DOUBLE_EQ(two_levels().distance_along(0, {0.2, 0.2, 3}, {0, 0, -1}, 0.0), 3.0);
  EXPECT_DOUBLE_EQ(two_levels().distance_along(0, {0.2, 0.2, -3}, {0, 0, 1}, 0.0), 3.0);
}

TEST(DistanceAlong, LooksAtOneGroup) {
  EXPECT_DOUBLE_EQ(two_levels().distance_along(1, {0.2, 0.2, 3}, {0, 0, -1}, 0.0), 1.0);
}

TEST(DistanceAlong, IsInfiniteWhereNothingIsMet) {
  EXPECT_TRUE(std::isinf(two_levels().distance_along(0, {0.8, 0.8, 3}, {0, 0, -1}, 0.0)));
  EXPECT_TRUE(std::isinf(two_levels().distance_along(0, {0.2, 0.2, 3}, {0, 0, 1}, 0.0)));
  EXPECT_TRUE(std::isinf(two_levels().distance_along(2, {0.2, 0.2, 3}, {0, 0, -1}, 0.0)));
}

TEST(DistanceAlong, PassesOverWhatIsNotFartherThanTheLeast) {
  const TriangleTree both({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 2}, {1, 0, 2}, {0, 1, 2}},
                          {{0, 1, 2}, {3, 4, 5}}, {0, 2});
  EXPECT_DOUBLE_EQ(both.distance_along(0, {0.2, 0.2, 0}, {0, 0, 1}, 1e-5), 2.0);
}

TEST(DistanceAlong, IsThatOfTheNearestOfManyTriangles) {
  const auto seed = std::random_device{}();
  std::cout << "seed " << seed << '\n';
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> along(-1.0f, 1.0f);
  const auto somewhere = [&] { return glm::vec3(along(random), along(random), along(random)); };
  std::vector<glm::vec3> vertices;
  std::vector<std::array<int32_t, 3>> triangles;
  for (int32_t t = 0; t < 300; ++t) {
    for (int k = 0; k < 3; ++k) vertices.push_back(somewhere());
    triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  const TriangleTree tree(vertices, triangles, {0, 300});
  for (int ray = 0; ray < 200; ++ray) {
    const glm::dvec3 from(2.0f * somewhere()), way = glm::normalize(glm::dvec3(somewhere()));
    double nearest = std::numeric_limits<double>::infinity();
    for (const auto& triangle : triangles) {
      const TriangleTree one(vertices, {triangle}, {0, 1});
      nearest = std::min(nearest, one.distance_along(0, from, way, 0.1));
    }
    EXPECT_EQ(tree.distance_along(0, from, way, 0.1), nearest);
  }
}

}  // namespace
}  // namespace snowbough::base
