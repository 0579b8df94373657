#include "base/triangle_tree.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/common.hpp>
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

TEST(FirstAlong, IsTheDistanceToATriangleFromBothSides) {
  EXPECT_DOUBLE_EQ(two_levels().first_along(0, {0.2, 0.2, 3}, {0, 0, -1}, 0.0).distance, 3.0);
  EXPECT_DOUBLE_EQ(two_levels().first_along(0, {0.2, 0.2, -3}, {0, 0, 1}, 0.0).distance, 3.0);
}

TEST(FirstAlong, LooksAtOneGroup) {
  EXPECT_DOUBLE_EQ(two_levels().first_along(1, {0.2, 0.2, 3}, {0, 0, -1}, 0.0).distance, 1.0);
}

TEST(FirstAlong, IsInfiniteWithoutAHit) {
  EXPECT_TRUE(std::isinf(two_levels().first_along(0, {0.8, 0.8, 3}, {0, 0, -1}, 0.0).distance));
  EXPECT_TRUE(std::isinf(two_levels().first_along(0, {0.2, 0.2, 3}, {0, 0, 1}, 0.0).distance));
  EXPECT_TRUE(std::isinf(two_levels().first_along(2, {0.2, 0.2, 3}, {0, 0, -1}, 0.0).distance));
}

TEST(FirstAlong, SkipsHitsWithinTheLeastDistance) {
  const TriangleTree both({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 2}, {1, 0, 2}, {0, 1, 2}},
                          {{0, 1, 2}, {3, 4, 5}}, {0, 2});
  EXPECT_DOUBLE_EQ(both.first_along(0, {0.2, 0.2, 0}, {0, 0, 1}, 1e-5).distance, 2.0);
}

TEST(FirstAlong, IsTheDistanceToTheNearestOfManyTriangles) {
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
      nearest = std::min(nearest, one.first_along(0, from, way, 0.1).distance);
    }
    EXPECT_EQ(tree.first_along(0, from, way, 0.1).distance, nearest);
  }
}

TEST(FirstAlong, HitsEdgesBetweenTriangles) {
  // A fan around a vertex: rays through its edges and through the vertex itself.
  std::vector<glm::vec3> vertices{{0.1f, 0.2f, 0.3f}};
  std::vector<std::array<int32_t, 3>> triangles;
  for (int32_t i = 0; i < 7; ++i) {
    const float turn = 0.9f * static_cast<float>(i);
    vertices.emplace_back(std::cos(turn), std::sin(turn), 0.1f * turn);
    triangles.push_back({0, 1 + i, 1 + (i + 1) % 7});
  }
  const TriangleTree fan(vertices, triangles, {0, 7});
  for (int32_t i = 1; i <= 7; ++i) {
    for (int32_t part = 0; part < 100; ++part) {
      const glm::dvec3 at = glm::mix(glm::dvec3(vertices[0]), glm::dvec3(vertices[i]), 0.01 * part);
      EXPECT_GE(fan.first_along(0, at + glm::dvec3(0, 0, 3), {0, 0, -1}, 0.0).triangle, 0)
          << i << ' ' << part;
    }
  }
}

TEST(FirstAlong, NamesTheTriangleAndOfTwoInOnePlaceTheFirst) {
  const TriangleTree twice({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {1, 2, 0}}, {0, 2});
  EXPECT_EQ(twice.first_along(0, {0.2, 0.2, 3}, {0, 0, -1}, 0.0).triangle, 0);
  EXPECT_EQ(twice.first_along(0, {0.2, 0.2, 3}, {0, 0, -1}, 0.0, 2.5).triangle, -1);
}

TEST(TriangleTree, FindsTheNearestWhateverTheHint) {
  std::vector<glm::vec3> vertices;
  std::vector<std::array<int32_t, 3>> triangles;
  for (int32_t t = 0; t < 30; ++t) {
    const auto x = static_cast<float>(t);
    for (const glm::vec3 corner : {glm::vec3(x, 0, 0), glm::vec3(x + 1, 0, 0), glm::vec3(x, 1, 0)})
      vertices.push_back(corner);
    triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  const TriangleTree tree(vertices, triangles, {0, 30});
  for (int32_t hint = -1; hint < 30; ++hint) {
    EXPECT_EQ(tree.nearest(0, {12.3, 0.2, 1.0}, hint).triangle, 12) << hint;
    // As near to two: the smaller index.
    EXPECT_EQ(tree.nearest(0, {12.0, 0.0, 1.0}, hint).triangle, 11) << hint;
  }
}

TEST(TriangleTree, MeetsMovedTrianglesAfterARefit) {
  std::vector<glm::vec3> vertices;
  std::vector<std::array<int32_t, 3>> triangles;
  for (int32_t t = 0; t < 40; ++t) {
    const auto x = static_cast<float>(t);
    for (const glm::vec3& corner : {glm::vec3(x, 0, 0), {x + 1, 0, 0}, {x, 1, 0}}) {
      vertices.push_back(corner);
    }
    triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  TriangleTree tree(vertices, triangles, {0, 40});
  for (glm::vec3& vertex : vertices) vertex += glm::vec3(100, 0, vertex.x);
  tree.refit(vertices, triangles);
  EXPECT_EQ(tree.first_along(0, {17.2, 0.2, 90}, {0, 0, -1}, 0.0).triangle, -1);
  const TriangleTree::Hit hit = tree.first_along(0, {117.2, 0.2, 90}, {0, 0, -1}, 0.0);
  EXPECT_EQ(hit.triangle, 17);
  EXPECT_NEAR(hit.distance, 90 - 17.2, 1e-4);
}

}  // namespace
}  // namespace snowbough::base
