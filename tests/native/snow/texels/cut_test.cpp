// cut_map: the chart that owns a texel, and the fragments of other charts in it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "native/snow/texels/rectangles.h"

namespace snowbough::snow {
namespace {

using ::testing::ElementsAre;

TEST(CutMap, GivesATexelToTheChartThatCoversMostOfIt) {
  const RectangleLayout layout = wide_and_speck();
  const TexelTableBuilder builder = layout.cut();
  EXPECT_THAT(builder.table.texel, ElementsAre(0, 1, 2, 3, 4));
  EXPECT_THAT(builder.table.chart, ElementsAre(0, 0, 0, 0, 0));
  EXPECT_THAT(builder.own_texels, ElementsAre(5, 0));
  ASSERT_EQ(builder.displaced.size(), 2u);
  EXPECT_EQ(builder.displaced[0].texel, 4);
  EXPECT_NEAR(builder.displaced[0].area + builder.displaced[1].area, 0.04, 1e-6);
}

}  // namespace
}  // namespace snowbough::snow
