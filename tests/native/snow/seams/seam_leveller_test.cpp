#include "snow/seams/seam_leveller.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

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

TEST(SeamLeveller, snowOnOneSideOnlyIsSpreadOverBoth) {
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

/// A straight seam: texels 0 to 15 of the one side lie half a texel beside 16 to 31 of the other,
/// and the points are a quarter of a texel apart.
SeamLevelling straight_seam(int32_t unknowns) {
  SeamLevelling levelling{{}, unknowns, {}, 1e-4f};
  for (int32_t texel = 0; texel < 32; ++texel) levelling.texel.push_back(texel);
  for (float at = 0.625f; at < 15.0f; at += 0.25f) {
    const auto a = static_cast<int32_t>(at);
    const auto b = static_cast<int32_t>(at - 0.5f);
    const float of_a = at - static_cast<float>(a);
    const float of_b = at - 0.5f - static_cast<float>(b);
    levelling.points.push_back(
        row({{a, of_a - 1.0f}, {a + 1, -of_a}, {16 + b, 1.0f - of_b}, {17 + b, of_b}}, 32));
  }
  return levelling;
}

/// The first eight texels of each side hold snow.
TEST(SeamLeveller, sidesAreEqualJustBeyondTheEndOfSnow) {
  const SeamLevelling levelling = straight_seam(32);
  std::vector<float> map(32, 0.0f);
  for (const size_t texel : {0, 1, 2, 3, 4, 5, 6, 7}) map[texel] = map[16 + texel] = 0.1f;
  SeamLeveller(levelling).run(map);
  EXPECT_NEAR(map[0], 0.1f, 1e-3f);
  EXPECT_NEAR(map[2], 0.1f, 1e-3f);
  for (const SeamRow& point : levelling.points) {
    float gap = 0.0f;
    for (int32_t t = 0; t < 4; ++t)
      gap += point.weight[t] * map[static_cast<size_t>(point.source[t])];
    const bool had_snow = point.source[0] < 8 || point.source[2] < 24;
    EXPECT_LE(std::fabs(gap), had_snow ? 5e-3f : 1e-4f) << point.source[0];
  }
}

TEST(SeamLeveller, aMapDoesNotDependOnTheOneBefore) {
  // The second side belongs to another chart.
  SeamLeveller leveller(straight_seam(16));
  std::vector<float> deep;
  for (int32_t texel = 0; texel < 32; ++texel) {
    deep.push_back(0.1f + 0.05f * static_cast<float>(7 * texel % 5));
  }
  leveller.run(deep);
  std::vector<float> bare(32, 0.0f);
  bare[3] = 0.1f;
  std::vector<float> fresh = bare;
  leveller.run(bare);
  SeamLeveller(straight_seam(16)).run(fresh);
  EXPECT_EQ(bare, fresh);
}

TEST(SeamLeveller, countsWhatItKeeps) {
  SeamLeveller leveller(two_sides(2));
  EXPECT_GT(leveller.bytes(), static_cast<int64_t>(sizeof(SeamRow)));
  EXPECT_LT(leveller.bytes(), 1024);
}

}  // namespace
}  // namespace snowbough::snow
