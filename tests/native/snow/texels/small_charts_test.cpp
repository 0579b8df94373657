// assign_texels_to_small_charts.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "native/snow/texels/rectangles.h"

namespace snowbough::snow {
namespace {

using ::testing::ElementsAre;

TEST(SmallCharts, TakeTheTexelTheyLieInWhereItsOwnerHasOthers) {
  const RectangleLayout layout = wide_and_speck();
  TexelTableBuilder builder = layout.cut();
  assign_texels_to_small_charts(builder);
  EXPECT_THAT(builder.table.chart, ElementsAre(0, 0, 0, 0, 1));
  EXPECT_EQ(builder.table.unmapped_charts, 0);
  EXPECT_NEAR(area_in(builder, 4, 1), 0.04, 1e-6);
  double displaced = 0.0;
  for (const Fragment& f : builder.displaced) {
    EXPECT_EQ(builder.chart_of(f.triangle), 0);
    displaced += f.area;
  }
  EXPECT_NEAR(displaced, 0.6, 1e-6);
}

TEST(SmallCharts, AreUnmappedWhereTheOwnerHasNothingElse) {
  const RectangleLayout layout =
      RectangleLayout().rectangle(0.0, 0.0, 0.6, 1.0).rectangle(0.7, 0.2, 0.9, 0.4);
  TexelTableBuilder builder = layout.cut();
  assign_texels_to_small_charts(builder);
  EXPECT_THAT(builder.table.chart, ElementsAre(0));
  EXPECT_EQ(builder.table.unmapped_charts, 1);
}

TEST(SmallCharts, DoNotTakeFromEachOther) {
  const RectangleLayout layout = wide_and_speck().rectangle(4.7, 0.6, 4.9, 0.9);
  TexelTableBuilder builder = layout.cut();
  assign_texels_to_small_charts(builder);
  EXPECT_THAT(builder.table.chart, ElementsAre(0, 0, 0, 0, 1));
  EXPECT_EQ(builder.table.unmapped_charts, 1);
}

}  // namespace
}  // namespace snowbough::snow
