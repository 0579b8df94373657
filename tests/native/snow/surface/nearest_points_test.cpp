#include "snow/surface/nearest_points.h"

#include <gtest/gtest.h>

namespace snowbough::snow {
namespace {

const std::vector<glm::vec3> kRow{{0.0f, 0, 0}, {0.1f, 0, 0}, {0.2f, 0, 0}, {5.0f, 0, 0}};

TEST(NearestPoints, LeaveOutPointsThatAreNotChosenAndThoseFarAway) {
  const std::vector<uint8_t> open(4, 0);
  const NearestPoints points(kRow, {0, 2, 3}, open, 0.2f);
  const PointMean mean = points.at({0.05f, 0, 0}, 1, 0.3f, false);
  // Points 1 and 3 would add 100.
  const float value = mean.of({1.0f, 100.0f, 3.0f, 100.0f});
  EXPECT_GT(value, 1.0f);
  EXPECT_LT(value, 2.0f);  // point 0 is nearer than point 2
  EXPECT_FLOAT_EQ(points.at({9, 0, 0}, 1, 0.3f, false).of({1.0f, 100.0f, 3.0f, 4.0f}), 100.0f);
}

TEST(NearestPoints, LeaveOutShelteredPointsUnlessTheyAreAskedFor) {
  const std::vector<uint8_t> sheltered{1, 0, 0, 0};
  const NearestPoints points(kRow, {0, 2}, sheltered, 0.2f);
  EXPECT_FLOAT_EQ(points.at({0.05f, 0, 0}, 1, 0.3f, false).of({1.0f, 9.0f, 3.0f, 9.0f}), 3.0f);
  EXPECT_LT(points.at({0.05f, 0, 0}, 1, 0.3f, true).of({1.0f, 9.0f, 3.0f, 9.0f}), 2.0f);
}

}  // namespace
}  // namespace snowbough::snow
