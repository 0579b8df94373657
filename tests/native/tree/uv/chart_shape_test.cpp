#include "tree/uv/chart_shape.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace snowbough::tree {
namespace {

using testing::Each;
using testing::ElementsAre;

/// A strip of rows 2 m long around a limb of 1 m perimeter.
Strip even_strip(int rows, double perimeter = 1.0) {
  Strip strip;
  strip.rings.resize(rows + 1);
  for (StripRing& ring : strip.rings) {
    ring.sides.fill(static_cast<float>(0.25 * perimeter));
  }
  strip.rows.resize(rows);
  strip.perimeters.assign(rows + 1, perimeter);
  strip.areas.assign(rows, 2.0 * perimeter);
  return strip;
}

std::vector<double> lengths_of(const Strip& strip, double scale) {
  std::vector<double> lengths;
  row_lengths(strip, scale, lengths);
  return lengths;
}

/// The outline of one chart on a grid of single texels.
PackShapes outline_of(const Strip& strip, const ChartShape& chart,
                      const std::vector<ChartRing>& rings) {
  ChartShapes shapes{{chart}, rings};
  PackShapes outlines;
  add_footprint(shapes, shapes.charts[0], strip, 1, outlines);
  return outlines;
}

TEST(Charts, ARowIsAsLongAsItsAreaOverItsWidth) {
  EXPECT_THAT(lengths_of(even_strip(3), 10.0), Each(20.0));
}

TEST(Charts, ARowWidenedToTwoTexelsIsShortenedToATenthAtMost) {
  // Twenty times too thin: its 20 texels become 2.
  EXPECT_THAT(lengths_of(even_strip(1, 0.01), 10.0), Each(testing::DoubleEq(2.0)));
}

TEST(Charts, AWidenedRowTakesHalfAsManyTexelsAgainAsItsShare) {
  // Half as wide as two texels: twice its share, were it as long.
  EXPECT_THAT(lengths_of(even_strip(1, 0.1), 10.0), Each(testing::DoubleEq(15.0)));
}

TEST(Charts, AChartStandsOnItsRootCap) {
  Strip strip = even_strip(2);
  strip.root_cap = 7;
  ChartShapes shapes;
  add_chart(strip, {0, 0, 2, true, false}, lengths_of(strip, 10.0), 10.0, 1000.0, shapes);
  const ChartShape& chart = shapes.charts.at(0);
  EXPECT_DOUBLE_EQ(chart.width, 10.0);
  EXPECT_DOUBLE_EQ(chart.height, 42.5);
  std::vector<double> heights;
  for (const ChartRing& ring : shapes.rings_of(chart)) {
    heights.push_back(ring.y);
  }
  EXPECT_THAT(heights, ElementsAre(2.5, 22.5, 42.5));
}

TEST(Charts, AFootprintCoversTheCellsThatTheChartTouches) {
  ChartShape chart;
  chart.piece = {0, 0, 2, false, false};
  chart.width = 10.0;
  chart.height = 26.0;
  const PackShapes outlines =
      outline_of(even_strip(2), chart, {{0.0, 10.0}, {20.0, 10.0}, {26.0, 4.0}});
  EXPECT_EQ(outlines.shapes[0].width, 10);
  EXPECT_EQ(outlines.shapes[0].height, 26);
  EXPECT_EQ(outlines.shapes[0].gutter, 2);
  // The upper row loses a column's width in every texel.
  EXPECT_THAT(
      outlines.columns,
      ElementsAre(CellRun{0, 26}, CellRun{0, 26}, CellRun{0, 26}, CellRun{0, 26}, CellRun{0, 26},
                  CellRun{0, 25}, CellRun{0, 24}, CellRun{0, 23}, CellRun{0, 22}, CellRun{0, 21}));
}

TEST(Charts, AFootprintBulgesInTheMiddleAndIsNarrowAtItsCaps) {
  ChartShape chart;
  chart.piece = {0, 0, 2, true, true};
  chart.root_cap = 1.5;
  chart.tip_cap = 0.5;
  chart.width = 6.0;
  chart.height = 10.0;
  // Caps are as wide as a side: a texel at the root, half of one at the tip.
  const PackShapes outlines =
      outline_of(even_strip(2), chart, {{1.5, 4.0}, {5.5, 6.0}, {9.5, 2.0}});
  EXPECT_THAT(outlines.columns, ElementsAre(CellRun{0, 10}, CellRun{1, 10}, CellRun{1, 10},
                                            CellRun{1, 9}, CellRun{1, 8}, CellRun{3, 7}));
}

TEST(Charts, AFootprintHasACellInEveryColumn) {
  // A needle tip of a column's width by nothing.
  ChartShape chart;
  chart.piece = {0, 0, 2, false, false};
  chart.width = 3.0;
  chart.height = 2.0;
  const PackShapes outlines =
      outline_of(even_strip(2), chart, {{0.0, 2.0}, {1.0, 3.0}, {2.0, 2.0}});
  for (const CellRun& run : outlines.columns) {
    EXPECT_LT(run.begin, run.end);
  }
}

}  // namespace
}  // namespace snowbough::tree
