#include "snow/scene/smooth_points.h"

#include <gtest/gtest.h>

namespace snowbough::snow {
namespace {

SceneObject object_with(const std::vector<int32_t>& shading, bool receive = true) {
  SceneObject object;
  object.description.receive = receive;
  object.description.shading = shading;
  object.description.topology.triangles.resize(6);
  return object;
}

TEST(SmoothPoints, AreNumberedThroughTheScene) {
  // The first object is flat, of the third one corner is.
  const SceneObject flat = object_with({});
  const SceneObject smooth = object_with({7, 9, 8, 9, 7, -5});
  const SceneObject half = object_with({-1, -1, -1, 4, 4, 4});
  const SmoothPoints points = find_smooth_points({&flat, &smooth, &half});
  ASSERT_EQ(points.count(), 5u);
  ASSERT_EQ(points.of_triangle.size(), 6u);
  for (const size_t triangle : {0, 1, 4}) {
    EXPECT_EQ(points.of_triangle[triangle].x, shared::kNowhere);
  }
  EXPECT_EQ(glm::uvec3(points.of_triangle[2]), glm::uvec3(0, 2, 1));
  EXPECT_EQ(glm::uvec3(points.of_triangle[3]), glm::uvec3(2, 0, 3));
  EXPECT_EQ(glm::uvec3(points.of_triangle[5]), glm::uvec3(4, 4, 4));
  EXPECT_EQ(points.begin, (std::vector<uint32_t>{0, 2, 3, 5, 6, 9}));
  EXPECT_EQ(points.corners, (std::vector<uint32_t>{6, 10, 8, 7, 9, 11, 15, 16, 17}));
}

TEST(SmoothPoints, OfFlatReceiversAndOfOccludersAreNone) {
  const SceneObject flat = object_with({-1, -1, -1, -1, -1, -1});
  const SceneObject occluder = object_with({0, 1, 2, 0, 2, 3}, false);
  const SmoothPoints points = find_smooth_points({&flat, &occluder});
  EXPECT_EQ(points.count(), 0u);
  EXPECT_TRUE(points.of_triangle.empty());
}

}  // namespace
}  // namespace snowbough::snow
