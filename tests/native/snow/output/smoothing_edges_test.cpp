// Smoother where snow ends.
#include <gtest/gtest.h>

#include <algorithm>

#include "native/snow/output/plates.h"

namespace snowbough::snow {
namespace {

TEST(SmoothingEdges, snowThatEndsInACliffEndsRounded) {
  const Map map = plate(128, 1.28f, 1.28f);
  std::vector<float> heights(128 * 128);
  for (size_t i = 0; i < heights.size(); ++i) heights[i] = i % 128 < 64 ? 0.15f : 0.0f;
  const auto smoothed = smooth(map, 0.02f, heights);
  const float* const row = &smoothed[64 * 128];
  EXPECT_LT(row[63], 0.05f);      // under a third at the rim
  EXPECT_GT(row[63 - 5], 0.14f);  // and full again a third of the depth further in
  EXPECT_LT(*std::max_element(row, row + 64), 0.185f);
  EXPECT_EQ(row[64], 0.0f);
}

TEST(SmoothingEdges, snowThatTapersOffGoesOnTaperingOff) {
  const Map map = plate(128, 1.28f, 1.28f);
  std::vector<float> heights(128 * 128, 0.0f);
  for (size_t i = 0; i < heights.size(); ++i) {
    heights[i] = std::clamp(0.01f * (static_cast<float>(i % 128) - 31.5f), 0.0f, 0.3f);
  }
  const auto smoothed = smooth(map, 0.02f, heights);
  for (size_t x = 32; x < 50; ++x) {
    const float height = heights[64 * 128 + x];
    EXPECT_NEAR(smoothed[64 * 128 + x], height, 0.15f * height + 0.006f) << "column " << x;
  }
}

TEST(SmoothingEdges, dustBesideDeepSnowStaysDust) {
  const Map map = plate(128, 1.28f, 1.28f);
  std::vector<float> heights(128 * 128);
  for (size_t i = 0; i < heights.size(); ++i) heights[i] = i % 128 < 63 ? 0.2f : 1e-4f;
  const auto smoothed = smooth(map, 0.02f, heights);
  for (size_t x = 63; x < 128; ++x) EXPECT_NEAR(smoothed[64 * 128 + x], 1e-4f, 1e-8f);
  EXPECT_LT(smoothed[64 * 128 + 62], 0.07f);
}

}  // namespace
}  // namespace snowbough::snow
