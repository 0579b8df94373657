#include "snow/output/smoothing_grid.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "native/snow/output/plates.h"

namespace snowbough::snow {
namespace {

TEST(RoundedHalf, IsExactToAPartIn256) {
  for (const float value : {0.0f, 1.0f, 1e-6f, 3.14159f, 1e6f}) {
    EXPECT_NEAR(from_half(rounded_half(value)), value, value / 256.0f);
  }
}

TEST(SmoothingGrid, HoldsInverseAreasAndZeroWithoutSurface) {
  const Map map = cut_strip();
  const SmoothingGrid grid = build_smoothing_grid(map.table, map.seams);
  EXPECT_NEAR(grid.inverse_area[10 * 64 + 10], 256.0f, 0.01f);
  EXPECT_EQ(grid.inverse_area[10 * 64 + 30], 0.0f);
}

TEST(SmoothingGrid, LinksNeighboursByHowCloseTheyAre) {
  const Map map = cut_strip();
  const SmoothingLevel level = build_smoothing_grid(map.table, map.seams).levels[0];
  EXPECT_EQ(level.size, 64);
  EXPECT_NEAR(from_half(level.to_right()[10 * 64 + 10]), 256.0f, 1.0f);
  EXPECT_NEAR(from_half(level.upwards()[10 * 64 + 10]), 256.0f, 1.0f);
  // The chart's last column and row.
  EXPECT_EQ(level.to_right()[10 * 64 + 23], 0);
  EXPECT_EQ(level.upwards()[23 * 64 + 10], 0);
}

TEST(SmoothingGrid, HoldsLinksAcrossASeamAtBothEnds) {
  const Map map = cut_strip();
  const SmoothingLevel level = build_smoothing_grid(map.table, map.seams).levels[0];
  const auto others_of = [&](int32_t cell) {
    const auto at = std::lower_bound(level.link_cell.begin(), level.link_cell.end(), cell);
    if (at == level.link_cell.end() || *at != cell) return std::vector<int32_t>{};
    const auto k = static_cast<size_t>(at - level.link_cell.begin());
    return std::vector<int32_t>(level.link_other.begin() + level.link_begin[k],
                                level.link_other.begin() + level.link_begin[k + 1]);
  };
  const int32_t left = 16 * 64 + 23;
  const int32_t right = 16 * 64 + 40;
  EXPECT_THAT(others_of(left), testing::Contains(right));
  EXPECT_THAT(others_of(right), testing::Contains(left));
  EXPECT_THAT(others_of(16 * 64 + 15), testing::IsEmpty());
}

TEST(SmoothingGrid, HalvesItsSideFromLevelToLevel) {
  const Map map = cut_strip();
  const SmoothingGrid grid = build_smoothing_grid(map.table, map.seams);
  ASSERT_GT(grid.levels.size(), 2u);
  for (size_t i = 1; i < grid.levels.size(); ++i) {
    EXPECT_EQ(grid.levels[i].size, grid.levels[i - 1].size / 2);
  }
  EXPECT_THAT(grid.levels.back().joins, testing::IsEmpty());
}

}  // namespace
}  // namespace snowbough::snow
