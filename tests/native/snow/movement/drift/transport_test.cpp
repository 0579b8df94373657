#include "snow/movement/drift/transport.h"

#include <gtest/gtest.h>

namespace snowbough::snow {
namespace {

constexpr double kFlux = 0.02;

/// Open ground of cells of 0.1 m under 0.2 m of snow.
DriftGrid field(int32_t columns, int32_t rows) {
  DriftGrid grid{columns, rows, 0.1, {}};
  grid.cells.assign(static_cast<size_t>(columns) * static_cast<size_t>(rows),
                    {.ground = 0.01, .top = 0.2, .loose = 0.002});
  return grid;
}

void put_fence(DriftGrid& grid, int32_t column, int32_t first_row, int32_t end_row) {
  for (int32_t row = first_row; row < end_row; ++row) {
    grid.at(column, row) = {.top = 1.0, .is_obstacle = true};
  }
}

TEST(Transport, leavesEvenSlopesAsTheyAre) {
  for (const double slope : {-0.3, 0.3}) {
    DriftGrid grid = field(64, 1);
    for (int32_t column = 0; column < 64; ++column) grid.at(column, 0).top -= slope * 0.1 * column;
    EXPECT_NEAR(transport(grid, kFlux), 0.0, 1e-15) << slope;
    for (const DriftCell& cell : grid.cells) EXPECT_NEAR(cell.change, 0.0, 1e-15);
  }
}

TEST(Transport, takesNoMoreThanLies) {
  DriftGrid grid = field(100, 1);
  put_fence(grid, 60, 0, 1);
  for (DriftCell& cell : grid.cells) cell.loose *= 1e-3;
  transport(grid, 10.0);
  for (const DriftCell& cell : grid.cells) EXPECT_GE(cell.loose, 0.0);
  EXPECT_EQ(grid.at(59, 0).loose, 0.0);
}

TEST(Transport, carriesSnowBesideAShelterIntoIt) {
  DriftGrid grid = field(200, 40);
  put_fence(grid, 60, 0, 20);
  transport(grid, kFlux);
  // In the open, but its carried snow spreads towards the calm.
  EXPECT_LT(grid.at(90, 20).change, 0.0);
  EXPECT_NEAR(grid.at(61, 30).change, 0.0, 1e-9);
  EXPECT_GT(grid.at(61, 10).change, 1e-4);
  EXPECT_GT(grid.at(90, 19).change, grid.at(90, 10).change);
}

TEST(Transport, carriesSnowOverAHoleAndDropsItIntoAStep) {
  DriftGrid grid = field(100, 1);
  for (int32_t column = 50; column < 100; ++column) {
    grid.at(column, 0) = {.ground = 0.01, .top = -0.8, .loose = 0.0};
  }
  for (int32_t column = 45; column < 50; ++column) grid.at(column, 0) = {};
  transport(grid, kFlux);
  EXPECT_EQ(grid.at(44, 0).change, 0.0);
  EXPECT_GT(grid.at(50, 0).change, 0.0);
  EXPECT_GT(grid.at(50, 0).change, grid.at(60, 0).change);
}

}  // namespace
}  // namespace snowbough::snow
