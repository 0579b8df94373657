// The order of a receiver's texels on the GPU.
#include "snow/surface_order.h"

#include <gtest/gtest.h>

namespace snowbough::snow {
namespace {

TEST(SurfaceOrder, GoesByChartThenBySquareThenByTheTablesOwnOrder) {
  TexelTable table;
  table.resolution = 64;
  table.chart_count = 2;
  // Columns 40, 3 and 4 of row 0, column 3 of row 1, column 3 of row 33.
  table.texel = {3, 4, 40, 64 + 3, 33 * 64 + 3};
  table.chart = {0, 1, 0, 0, 0};
  EXPECT_EQ(surface_order(table), (std::vector<int32_t>{0, 3, 2, 4, 1}));
}

TEST(SurfaceOrder, OfNothingIsNothing) {
  TexelTable table;
  table.resolution = 64;
  EXPECT_TRUE(surface_order(table).empty());
}

}  // namespace
}  // namespace snowbough::snow
