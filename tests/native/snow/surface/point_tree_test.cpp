#include "snow/surface/point_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace snowbough::snow {
namespace {

/// Points in a cube, some of them equal.
std::vector<glm::vec3> random_points(std::mt19937& random) {
  std::uniform_int_distribution<int> place(0, 12);
  std::vector<glm::vec3> points;
  for (int i = 0; i < 500; ++i) {
    points.emplace_back(place(random), place(random), place(random));
  }
  return points;
}

TEST(PointTree, FindsTheNearestPoints) {
  std::mt19937 random(7);
  const std::vector<glm::vec3> points = random_points(random);
  const PointTree tree(points);
  for (const glm::vec3& place : {glm::vec3(6, 6, 6), glm::vec3(-2, 3.3f, 14), glm::vec3(40)}) {
    std::vector<std::pair<float, int32_t>> wanted;
    for (size_t p = 0; p < points.size(); ++p) {
      const float distance = glm::distance(points[p], place);
      if (distance < 5.0f) wanted.emplace_back(distance, static_cast<int32_t>(p));
    }
    std::sort(wanted.begin(), wanted.end());
    wanted.resize(4, {5.0f, -1});
    const auto found = tree.nearest(place, 5.0f);
    for (size_t k = 0; k < 4; ++k) {
      EXPECT_EQ(found[k].distance, wanted[k].first);
      EXPECT_EQ(found[k].point, wanted[k].second);
    }
  }
}

TEST(PointTree, VisitsThePointsWithinAReachOnce) {
  std::mt19937 random(8);
  const std::vector<glm::vec3> points = random_points(random);
  const PointTree tree(points);
  const glm::vec3 place(5, 7, 3);
  std::vector<int> visits(points.size(), 0);
  tree.visit_within(place, 4.0f, [&](int32_t begin, int32_t end) {
    for (int32_t i = begin; i < end; ++i) ++visits[tree.order()[i]];
  });
  for (size_t p = 0; p < points.size(); ++p) {
    EXPECT_EQ(visits[p], glm::distance(points[p], place) <= 4.0f ? 1 : 0) << p;
  }
}

TEST(PointTree, VisitsACrowdAsOne) {
  const PointTree tree(std::vector<glm::vec3>(5000, glm::vec3(1)));
  int ranges = 0;
  tree.visit_within({1, 1, 1.5f}, 1.0f, [&](int32_t begin, int32_t end) {
    ++ranges;
    EXPECT_EQ(end - begin, 5000);
  });
  EXPECT_EQ(ranges, 1);
}

TEST(PointTree, OfNoPointsFindsNone) {
  const PointTree tree({});
  EXPECT_EQ(tree.nearest({0, 0, 0}, 1.0f)[0].point, -1);
  tree.visit_within({0, 0, 0}, 1.0f, [&](int32_t, int32_t) { ADD_FAILURE(); });
}

}  // namespace
}  // namespace snowbough::snow
