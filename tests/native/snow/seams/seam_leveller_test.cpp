#include "snow/seams/seam_leveller.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "native/snow/seams/problems.h"

namespace snowbough::snow {
namespace {

/// One point whose sides show texel 3 and texel 5 of a map of 8; the latter another chart's where
/// there is but one unknown.
SeamLevelling two_sides(int32_t unknowns) {
  return {{3, 5}, unknowns, {row({{0, -1.0f}, {1, 1.0f}}, 2)}, 1e-3f};
}

TEST(SeamLeveller, twoSidesMeetInTheMiddle) {
  std::vector<float> map{0.3f, 0.3f, 0.3f, 0.1f, 0.3f, 0.2f, 0.3f, 0.3f};
  SeamLeveller(two_sides(2)).run(map);
  EXPECT_NEAR(map[3], 0.15f, 1e-3f);
  EXPECT_NEAR(map[3], map[5], 0.005f * 0.15f);
  for (const int texel : {0, 1, 2, 4, 6, 7}) EXPECT_EQ(map[texel], 0.3f);
}

TEST(SeamLeveller, aTexelOfAnotherChartStaysAsItIs) {
  std::vector<float> map{0.0f, 0.0f, 0.0f, 0.1f, 0.0f, 0.2f, 0.0f, 0.0f};
  SeamLeveller(two_sides(1)).run(map);
  EXPECT_EQ(map[5], 0.2f);
  EXPECT_NEAR(map[3], 0.2f, 0.005f * 0.2f);
}

TEST(SeamLeveller, noSnowStaysNoSnow) {
  std::vector<float> map(8, 0.0f);
  SeamLeveller(two_sides(2)).run(map);
  EXPECT_THAT(map, testing::Each(0.0f));
}

TEST(SeamLeveller, snowThatOneSideAloneHasIsSharedOut) {
  std::vector<float> map(8, 0.0f);
  map[5] = 0.2f;
  SeamLeveller(two_sides(2)).run(map);
  EXPECT_NEAR(map[3], 0.1f, 2e-3f);
  EXPECT_NEAR(map[5], 0.1f, 2e-3f);
}

/// Sides that only a texel below 0 could make even: another chart's show 1 and 3 where one side is
/// 0.5 a + 0.5 b, the other 0.1 a + 0.9 b; b = 3.5 and a = -1.5 would do.
TEST(SeamLeveller, staysBetweenNothingAndTheHighestAround) {
  const SeamLevelling levelling{
      {0, 1, 2, 3},
      2,
      {row({{0, 0.5f}, {1, 0.5f}, {2, -1.0f}}, 4), row({{0, 0.1f}, {1, 0.9f}, {3, -1.0f}}, 4)},
      1e-3f};
  std::vector<float> map{2.0f, 2.0f, 1.0f, 3.0f};
  SeamLeveller(levelling).run(map);
  EXPECT_GE(map[0], 0.0f);
  EXPECT_LE(map[1], 3.0f);
  // With a at 0, b is between 2, which the one side wants, and 3, for the other.
  EXPECT_NEAR(map[0], 0.0f, 0.05f);
  EXPECT_GT(map[1], 2.0f);
}

TEST(SeamLeveller, countsWhatItKeeps) {
  SeamLeveller leveller(two_sides(2));
  EXPECT_GT(leveller.bytes(), static_cast<int64_t>(sizeof(SeamRow)));
  EXPECT_LT(leveller.bytes(), 1024);
}

}  // namespace
}  // namespace snowbough::snow
