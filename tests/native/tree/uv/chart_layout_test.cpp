#include "tree/uv/chart_layout.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace snowbough::tree {
namespace {

/// Cones of four sides, without caps: `perimeter` at the root, a tenth of it at the tip.
Strip cone(double length, double perimeter, int rows) {
  Strip strip;
  strip.rings.resize(rows + 1);
  strip.rows.resize(rows);
  for (int ring = 0; ring <= rows; ++ring) {
    strip.perimeters.push_back(perimeter * (1.0 - 0.9 * ring / rows));
    strip.rings[ring].sides.fill(static_cast<float>(0.25 * strip.perimeters.back()));
  }
  for (int row = 0; row < rows; ++row) {
    strip.rows[row].cells.fill({0, -1});
    strip.areas.push_back(0.5 * (strip.perimeters[row] + strip.perimeters[row + 1]) * length /
                          rows);
  }
  strip.ranges = {{0, rows}};
  return strip;
}

/// A few thick limbs and many thin ones.
std::vector<Strip> cones(int count) {
  std::mt19937 random(8);
  std::vector<Strip> strips;
  for (int i = 0; i < count; ++i) {
    const double length = 0.05 + 3.0 / (1.0 + static_cast<double>(random() % 40));
    strips.push_back(cone(length, length * 0.06, 4 + static_cast<int>(random() % 9)));
  }
  return strips;
}

TEST(ChartLayout, TakesNearlyAllColumnsOfTheMap) {
  for (const int count : {100, 1000}) {
    for (const int resolution : {256, 1024, 2048}) {
      const auto layout = lay_out_charts(cones(count), resolution, {});
      ASSERT_TRUE(layout);
      EXPECT_LE(layout->packing.used_columns, resolution) << count << " at " << resolution;
      EXPECT_GE(layout->packing.used_columns, 0.95 * resolution) << count << " at " << resolution;
    }
  }
}

TEST(ChartLayout, ASecondOrThirdAttemptSuffices) {
  for (const int count : {100, 1000}) {
    int reports = 0;
    const base::Execution counted{1, [&reports](float) { return ++reports > 0; }};
    ASSERT_TRUE(lay_out_charts(cones(count), 1024, counted));
    EXPECT_LE(reports, 3) << count;
  }
}

TEST(ChartLayout, ASingleLimbIsAsLargeAsTheMapAllows) {
  const auto layout = lay_out_charts({cone(1.0, 0.5, 1)}, 512, {});
  ASSERT_TRUE(layout);
  EXPECT_GE(layout->shapes.charts[0].height, 500.0);
}

TEST(ChartLayout, LargeMapsArePackedInCellsOfSeveralTexels) {
  const auto layout = lay_out_charts(cones(100), 4096, {});
  ASSERT_TRUE(layout);
  EXPECT_EQ(layout->map.cell_size, 2);
  EXPECT_LE(layout->packing.used_columns, 2048);
}

TEST(ChartLayout, ChartsThatHardlyFitAreLaidOutAtTheirSmallest) {
  // Charts of two texels squared with a texel around them: nine texels each, in 30 squared.
  const auto layout = lay_out_charts(std::vector<Strip>(95, cone(1.0, 0.1, 1)), 32, {});
  ASSERT_TRUE(layout);
  EXPECT_LE(layout->packing.used_columns, 32);
  EXPECT_FALSE(lay_out_charts(std::vector<Strip>(110, cone(1.0, 0.1, 1)), 32, {}));
}

}  // namespace
}  // namespace snowbough::tree
