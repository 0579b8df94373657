// The order of a receiver's texels on the GPU.
#include "snow/texels/texel_order.h"

#include <gtest/gtest.h>

namespace snowbough::snow {
namespace {

TEST(SurfaceOrder, IsByChartThenBySquareThenByNumber) {
  TexelTable table;
  table.resolution = 64;
  table.chart_count = 2;
  // Columns 40, 3 and 4 of row 0, column 3 of row 1, column 3 of row 33.
  table.texel = {3, 4, 40, 64 + 3, 33 * 64 + 3};
  table.chart = {0, 1, 0, 0, 0};
  table.fragment_begin = {0, 1, 2, 3, 4, 5};
  EXPECT_EQ(texel_order(table), (std::vector<int32_t>{0, 3, 2, 4, 1}));
}

TEST(SurfaceOrder, PutsTexelsOfFewFragmentsFirstInTheirWorkGroup) {
  TexelTable table;
  table.resolution = 64;
  table.chart_count = 1;
  // Rows 0 to 31 of the left half fill a work group; a texel of two fragments in it, one behind it.
  for (int32_t row = 0; row < 33; ++row) {
    for (int32_t column = 0; column < 32; ++column) {
      table.texel.push_back(row * 64 + column);
    }
  }
  table.chart.assign(table.texel.size(), 0);
  for (int32_t i = 0; i <= 33 * 32; ++i) {
    table.fragment_begin.push_back(i + (i > 5 ? 1 : 0) + (i > 1024 + 7 ? 1 : 0));
  }
  const std::vector<int32_t> order = texel_order(table);
  EXPECT_EQ(order[4], 4);
  EXPECT_EQ(order[5], 6);
  EXPECT_EQ(order[1023], 5);
  EXPECT_EQ(order[1024], 1024);
  EXPECT_EQ(order.back(), 1024 + 7);
}

TEST(SurfaceOrder, OfNothingIsNothing) {
  TexelTable table;
  table.resolution = 64;
  EXPECT_TRUE(texel_order(table).empty());
}

}  // namespace
}  // namespace snowbough::snow
