#include "tree/surface/limb_path.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <random>
#include <string>

namespace snowbough::tree {
namespace {

LimbPath path_through(std::vector<glm::dvec3> points) {
  LimbPath path;
  path.points = std::move(points);
  path.corners.assign(path.points.size(), 0.1);
  measure(path);
  return path;
}

TEST(PathSearch, FindsTheNearestPlace) {
  const LimbPath path = path_through({{0, 0, 0}, {0, 0, 2}, {3, 0, 2}});
  EXPECT_DOUBLE_EQ(PathSearch(path).nearest_length({1, 1, 3}), 3.0);
}

TEST(PathSearch, OfEquallyNearPlacesTakesTheFirst) {
  std::vector<glm::dvec3> zigzag;
  for (int i = 0; i < 101; ++i) zigzag.emplace_back(i % 2, 0, 0);
  const LimbPath path = path_through(std::move(zigzag));
  EXPECT_DOUBLE_EQ(PathSearch(path).nearest_length({0.5, 1, 0}), 0.5);
}

TEST(PathSearch, IsTheSearchThroughAllSegmentsToTheBit) {
  constexpr uint32_t kSeed = 5;
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  std::mt19937 random(kSeed);
  const auto unit = [&] { return static_cast<double>(random()) * 0x1p-32; };
  for (int limb = 0; limb < 50; ++limb) {
    std::vector<glm::dvec3> points{{100.0 * unit(), 0.0, 0.0}};
    for (int i = 0; i < 1 + 7 * limb; ++i) {
      points.push_back(points.back() + glm::dvec3(unit() - 0.5, unit() - 0.5, unit()));
    }
    const LimbPath path = path_through(std::move(points));
    const PathSearch search(path);
    for (int i = 0; i < 200; ++i) {
      const glm::dvec3 point = path.points[random() % path.points.size()] +
                               2.0 * glm::dvec3(unit() - 0.5, unit() - 0.5, unit() - 0.5);
      ASSERT_EQ(search.nearest_length(point), nearest_length(path, point));
    }
  }
}

}  // namespace
}  // namespace snowbough::tree
