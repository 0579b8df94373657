#include "tree/uv/pack_charts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace snowbough::tree {
namespace {

/// A chart by itself.
struct Chart {
  int height = 0;
  int gutter = 1;
  std::vector<CellRun> columns;
};

Chart rectangle(int width, int height, int gutter = 1) {
  return {height, gutter, std::vector<CellRun>(width, CellRun{0, height})};
}

/// As wide as it is high in steps: column j reaches up to height - j * height / width.
Chart wedge(int width, int height, int gutter = 1) {
  Chart chart = rectangle(width, height, gutter);
  for (int j = 0; j < width; ++j) {
    chart.columns[j].end = height - j * height / width;
  }
  return chart;
}

PackShapes all_of(const std::vector<Chart>& charts) {
  PackShapes shapes;
  for (const Chart& chart : charts) {
    shapes.shapes.push_back({static_cast<int>(chart.columns.size()), chart.height, chart.gutter,
                             shapes.columns.size()});
    shapes.columns.insert(shapes.columns.end(), chart.columns.begin(), chart.columns.end());
  }
  return shapes;
}

/// On a square grid.
std::optional<Packing> pack(const std::vector<Chart>& charts, int grid) {
  return pack_charts(all_of(charts), grid, grid);
}

/// Owner of every cell, -1 = free. Fails the test where two charts share one.
std::vector<int> draw(const std::vector<Chart>& charts, const std::vector<Placement>& places,
                      int grid) {
  std::vector<int> owner(static_cast<size_t>(grid) * grid, -1);
  for (size_t i = 0; i < charts.size(); ++i) {
    const auto width = static_cast<int>(charts[i].columns.size());
    for (int j = 0; j < width; ++j) {
      for (int t = charts[i].columns[j].begin; t < charts[i].columns[j].end; ++t) {
        const int x = places[i].x + (places[i].columns_reversed ? width - 1 - j : j);
        const int y = places[i].y + (places[i].rows_reversed ? charts[i].height - 1 - t : t);
        EXPECT_TRUE(x >= 1 && y >= 1 && x < grid - 1 && y < grid - 1) << x << ", " << y;
        int& cell = owner[static_cast<size_t>(y) * grid + x];
        EXPECT_EQ(cell, -1) << "charts " << cell << " and " << i << " share " << x << ", " << y;
        cell = static_cast<int>(i);
      }
    }
  }
  return owner;
}

int cells_closer_than_their_gutters(const std::vector<Chart>& charts, const std::vector<int>& owner,
                                    int grid) {
  int count = 0;
  for (int y = 0; y < grid; ++y) {
    for (int x = 0; x < grid; ++x) {
      const int own = owner[static_cast<size_t>(y) * grid + x];
      for (int dy = -2; own >= 0 && dy <= 2; ++dy) {
        for (int dx = -2; dx <= 2; ++dx) {
          const int nx = x + dx;
          const int ny = y + dy;
          if (nx < 0 || ny < 0 || nx >= grid || ny >= grid) continue;
          const int other = owner[static_cast<size_t>(ny) * grid + nx];
          const int distance = std::max(std::abs(dx), std::abs(dy));
          count += other >= 0 && other != own &&
                   distance <= std::max(charts[own].gutter, charts[other].gutter);
        }
      }
    }
  }
  return count;
}

TEST(PackCharts, PutsASingleChartIntoTheLowerLeftCorner) {
  const auto packing = pack({rectangle(3, 4)}, 16);
  ASSERT_TRUE(packing);
  EXPECT_EQ(packing->placements[0].x, 1);
  EXPECT_EQ(packing->placements[0].y, 1);
}

TEST(PackCharts, FillsTheMapUpToItsBorder) {
  EXPECT_TRUE(pack({rectangle(14, 14)}, 16));
  EXPECT_FALSE(pack({rectangle(15, 14)}, 16));
  EXPECT_FALSE(pack({rectangle(14, 15)}, 16));
}

TEST(PackCharts, KeepsTheLargerOfTwoGutters) {
  // 14 free cells: 6 + 2 + 6 fit, 6 + 2 + 7 do not.
  EXPECT_TRUE(pack({rectangle(6, 14, 2), rectangle(6, 14, 1)}, 16));
  EXPECT_FALSE(pack({rectangle(6, 14, 2), rectangle(7, 14, 1)}, 16));
  EXPECT_FALSE(pack({rectangle(7, 14, 1), rectangle(6, 14, 2)}, 16));
  EXPECT_TRUE(pack({rectangle(7, 14, 1), rectangle(6, 14, 1)}, 16));
}

TEST(PackCharts, SaysHowManyColumnsItTook) {
  // Two charts side by side, a cell between them and one along either border.
  const PackShapes shapes = all_of({rectangle(3, 14), rectangle(5, 14)});
  EXPECT_EQ(pack_charts(shapes, 16, 40)->used_columns, 1 + 5 + 1 + 3 + 1);
  EXPECT_EQ(pack_charts(shapes, 32, 40)->used_columns, 1 + 5 + 1);
}

TEST(PackCharts, NestsWedgesHeadToTail) {
  // Side by side they would need 10 + 1 + 10 columns.
  const std::vector<Chart> charts{wedge(10, 14), wedge(10, 14)};
  const auto packing = pack(charts, 16);
  ASSERT_TRUE(packing);
  const std::vector<Placement>& places = packing->placements;
  EXPECT_NE(places[0].rows_reversed, places[1].rows_reversed);
  EXPECT_EQ(cells_closer_than_their_gutters(charts, draw(charts, places, 16), 16), 0);
}

TEST(PackCharts, FillsHolesThatLargerChartsLeft) {
  // The 13 columns right of the wedge's upper half take the four squares.
  const std::vector<Chart> charts{rectangle(2, 2), rectangle(2, 2), rectangle(2, 2),
                                  rectangle(2, 2), wedge(14, 14)};
  const auto packing = pack(charts, 16);
  ASSERT_TRUE(packing);
  EXPECT_EQ(cells_closer_than_their_gutters(charts, draw(charts, packing->placements, 16), 16), 0);
}

std::vector<Chart> random_charts(std::mt19937& random, int grid) {
  const auto pick = [&random](int low, int high) {
    return low + static_cast<int>(random() % static_cast<unsigned>(high - low + 1));
  };
  std::vector<Chart> charts;
  for (int i = 0; i < grid / 3; ++i) {
    Chart chart = rectangle(pick(1, 7), pick(2, grid / 3), pick(1, 2));
    for (CellRun& run : chart.columns) {
      run = {pick(0, chart.height / 4), pick(chart.height / 2 + 1, chart.height)};
    }
    charts.push_back(chart);
  }
  return charts;
}

TEST(PackCharts, RandomChartsNeverComeCloserThanTheirGutters) {
  constexpr unsigned kSeed = 20261121;
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  for (const int grid : {63, 64, 65, 130}) {
    const std::vector<Chart> charts = random_charts(random, grid);
    const auto packing = pack(charts, grid);
    ASSERT_TRUE(packing) << grid;
    const std::vector<int> owner = draw(charts, packing->placements, grid);
    EXPECT_EQ(cells_closer_than_their_gutters(charts, owner, grid), 0) << grid;
  }
}

/// Runs of free cells in the fullest column.
int most_gaps(const std::vector<int>& owner, int grid) {
  int most = 0;
  for (int x = 0; x < grid; ++x) {
    int gaps = 0;
    for (int y = 1; y < grid; ++y) {
      gaps += owner[static_cast<size_t>(y) * grid + x] < 0 &&
              owner[static_cast<size_t>(y - 1) * grid + x] >= 0;
    }
    most = std::max(most, gaps);
  }
  return most;
}

TEST(PackCharts, KeepsTrackOfColumnsInManyPieces) {
  // Crosses leave a gap above and below each arm that the next one's middle does not fill.
  std::vector<Chart> charts;
  for (int i = 0; i < 40; ++i) {
    Chart cross = rectangle(9, 9);
    for (const int j : {0, 1, 2, 3, 5, 6, 7, 8}) {
      cross.columns[j] = {4, 5};
    }
    charts.push_back(cross);
  }
  charts.push_back(rectangle(3, 3));
  const int grid = 400;
  const auto packing = pack(charts, grid);
  ASSERT_TRUE(packing);
  const std::vector<int> owner = draw(charts, packing->placements, grid);
  EXPECT_GT(most_gaps(owner, grid), 30);
  EXPECT_EQ(cells_closer_than_their_gutters(charts, owner, grid), 0);
}

TEST(PackCharts, TheOrderOfTheChartsChangesNothingButTheirNumbers) {
  std::mt19937 random(3);
  std::vector<Chart> charts = random_charts(random, 96);
  const auto packing = pack(charts, 96);
  std::reverse(charts.begin(), charts.end());
  const auto reversed = pack(charts, 96);
  ASSERT_TRUE(packing && reversed);
  EXPECT_EQ(packing->used_columns, reversed->used_columns);
}

TEST(PackCharts, NoChartsNeedNoRoom) {
  EXPECT_THAT(pack({}, 16)->placements, testing::IsEmpty());
}

}  // namespace
}  // namespace snowbough::tree
