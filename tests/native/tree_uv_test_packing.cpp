#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "tree/pack_charts.h"

namespace snowbough::tree {
namespace {

PackShape rectangle(int width, int height, int gutter = 1) {
  return {width, height, std::vector<int>(width, 0), std::vector<int>(width, height), gutter};
}

/// As wide as it is high in steps: column j reaches up to height - j * height / width.
PackShape wedge(int width, int height, int gutter = 1) {
  PackShape shape = rectangle(width, height, gutter);
  for (int j = 0; j < width; ++j) {
    shape.end[j] = height - j * height / width;
  }
  return shape;
}

/// Owner of every cell, -1 = free. Fails the test where two charts share one.
std::vector<int> draw(const std::vector<PackShape>& shapes, const std::vector<Placement>& places,
                      int grid) {
  std::vector<int> owner(static_cast<size_t>(grid) * grid, -1);
  for (size_t i = 0; i < shapes.size(); ++i) {
    const PackShape& shape = shapes[i];
    for (int j = 0; j < shape.width; ++j) {
      for (int t = shape.begin[j]; t < shape.end[j]; ++t) {
        const int x = places[i].x + (places[i].columns_reversed ? shape.width - 1 - j : j);
        const int y = places[i].y + (places[i].rows_reversed ? shape.height - 1 - t : t);
        EXPECT_TRUE(x >= 1 && y >= 1 && x < grid - 1 && y < grid - 1) << x << ", " << y;
        int& cell = owner[static_cast<size_t>(y) * grid + x];
        EXPECT_EQ(cell, -1) << "charts " << cell << " and " << i << " share " << x << ", " << y;
        cell = static_cast<int>(i);
      }
    }
  }
  return owner;
}

int cells_closer_than_their_gutters(const std::vector<PackShape>& shapes,
                                    const std::vector<int>& owner, int grid) {
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
                   distance <= std::max(shapes[own].gutter, shapes[other].gutter);
        }
      }
    }
  }
  return count;
}

TEST(PackCharts, PutsASingleChartIntoTheLowerLeftCorner) {
  const auto places = pack_charts({rectangle(3, 4)}, 16);
  ASSERT_TRUE(places);
  EXPECT_EQ((*places)[0].x, 1);
  EXPECT_EQ((*places)[0].y, 1);
}

TEST(PackCharts, FillsTheMapUpToItsBorder) {
  EXPECT_TRUE(pack_charts({rectangle(14, 14)}, 16));
  EXPECT_FALSE(pack_charts({rectangle(15, 14)}, 16));
  EXPECT_FALSE(pack_charts({rectangle(14, 15)}, 16));
}

TEST(PackCharts, KeepsTheLargerOfTwoGutters) {
  // 14 free cells: 6 + 2 + 6 fit, 6 + 2 + 7 do not.
  EXPECT_TRUE(pack_charts({rectangle(6, 14, 2), rectangle(6, 14, 1)}, 16));
  EXPECT_FALSE(pack_charts({rectangle(6, 14, 2), rectangle(7, 14, 1)}, 16));
  EXPECT_FALSE(pack_charts({rectangle(7, 14, 1), rectangle(6, 14, 2)}, 16));
  EXPECT_TRUE(pack_charts({rectangle(7, 14, 1), rectangle(6, 14, 1)}, 16));
}

TEST(PackCharts, NestsWedgesHeadToTail) {
  // Side by side they would need 10 + 1 + 10 columns.
  const std::vector<PackShape> shapes{wedge(10, 14), wedge(10, 14)};
  const auto places = pack_charts(shapes, 16);
  ASSERT_TRUE(places);
  EXPECT_NE((*places)[0].rows_reversed, (*places)[1].rows_reversed);
  EXPECT_EQ(cells_closer_than_their_gutters(shapes, draw(shapes, *places, 16), 16), 0);
}

TEST(PackCharts, RandomChartsNeverComeCloserThanTheirGutters) {
  constexpr unsigned kSeed = 20261121;
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  const auto pick = [&random](int low, int high) {
    return low + static_cast<int>(random() % static_cast<unsigned>(high - low + 1));
  };
  for (const int grid : {63, 64, 65, 130}) {
    std::vector<PackShape> shapes;
    for (int i = 0; i < grid / 3; ++i) {
      PackShape shape = rectangle(pick(1, 7), pick(2, grid / 3), pick(1, 2));
      for (int j = 0; j < shape.width; ++j) {
        shape.begin[j] = pick(0, shape.height / 4);
        shape.end[j] = pick(shape.height / 2 + 1, shape.height);
      }
      shapes.push_back(shape);
    }
    const auto places = pack_charts(shapes, grid);
    ASSERT_TRUE(places) << grid;
    EXPECT_EQ(cells_closer_than_their_gutters(shapes, draw(shapes, *places, grid), grid), 0)
        << grid;
  }
}

TEST(PackCharts, NoChartsNeedNoRoom) {
  EXPECT_THAT(*pack_charts({}, 16), testing::IsEmpty());
}

}  // namespace
}  // namespace snowbough::tree
