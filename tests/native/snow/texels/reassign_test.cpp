// reassign_displaced_fragments.
#include <gtest/gtest.h>

#include "native/snow/texels/rectangles.h"

namespace snowbough::snow {
namespace {

TEST(DisplacedFragments, GoToTheirChartsNearestTexel) {
  const RectangleLayout layout = wide_and_speck();
  TexelTableBuilder builder = layout.cut();
  assign_texels_to_small_charts(builder);
  reassign_displaced_fragments(builder);
  EXPECT_NEAR(area_in(builder, 3, 0), 1.6, 1e-6);
  EXPECT_NEAR(area_in(builder, 4, 0), 0.0, 1e-6);
  EXPECT_NEAR(total_area(builder), 4.64, 1e-5);
}

TEST(DisplacedFragments, OfAnUnmappedChartStayWhereTheyAre) {
  const RectangleLayout layout =
      RectangleLayout().rectangle(0.0, 0.0, 0.6, 1.0).rectangle(0.7, 0.2, 0.9, 0.4);
  TexelTableBuilder builder = layout.cut();
  assign_texels_to_small_charts(builder);
  reassign_displaced_fragments(builder);
  EXPECT_NEAR(area_in(builder, 0, 1), 0.04, 1e-6);
  EXPECT_NEAR(total_area(builder), 0.64, 1e-5);
}

}  // namespace
}  // namespace snowbough::snow
