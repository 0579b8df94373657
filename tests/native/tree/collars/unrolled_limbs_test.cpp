#include "tree/collars/unrolled_limbs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "native/tree/collars/built_tubes.h"

namespace snowbough::tree {
namespace {

constexpr int kAround = 16, kAlong = 21;

/// The trunk of a fork as a regular grid with a hole of two by two faces in it, whose collar is to
/// move by `distance` metres along the trunk.
struct GridWithHole {
  BuiltTubes built{make_skeleton({trunk(0.2f), side_branch(5.5f, 0.1f)})};
  UnrolledLimbs unrolled;
  std::vector<Collar> collars{1};

  static int32_t vertex(int around, int along) { return along * kAround + around % kAround; }

  explicit GridWithHole(double distance) {
    const double quarter = 4.0 / kAround, step = 0.08;
    for (int y = 0; y < kAlong; ++y) {
      for (int x = 0; x < kAround; ++x) {
        unrolled.places.push_back({5.5 + step * (y - kAlong / 2), quarter * x});
        unrolled.fixed.push_back(y == 0 || y + 1 == kAlong);
        unrolled.chain.push_back(0);
        if (y + 1 < kAlong && !(x / 2 == 4 && (y == 9 || y == 10))) {
          unrolled.quads.push_back(
              {vertex(x, y), vertex(x + 1, y), vertex(x + 1, y + 1), vertex(x, y + 1)});
        }
      }
    }
    constexpr std::pair<int, int> kCollar[] = {{8, 9},   {9, 9},  {10, 9}, {10, 10},
                                               {10, 11}, {9, 11}, {8, 11}, {8, 10}};
    for (const auto& [x, y] : kCollar) {
      CollarPoint point;
      point.vertex = vertex(x, y);
      point.base = point.target = unrolled.places[point.vertex];
      point.target.length += distance;
      collars[0].push_back(point);
    }
  }

  void move() { move_collars(collars, built.forks, built.tubes, 1, unrolled); }
};

TEST(UnrolledLimbs, ACollarThatHasRoomReachesItsTarget) {
  GridWithHole grid(0.2);
  grid.move();
  for (const CollarPoint& point : grid.collars[0]) {
    EXPECT_DOUBLE_EQ(grid.unrolled.shares[point.vertex], 1.0);
    EXPECT_NEAR(grid.unrolled.places[point.vertex].length, point.target.length, 1e-12);
    EXPECT_NEAR(grid.unrolled.places[point.vertex].quarter, point.target.quarter, 1e-12);
  }
}

TEST(UnrolledLimbs, WhatLiesBeforeACollarGivesWayInItsOrder) {
  GridWithHole grid(0.3);
  grid.move();
  for (int x = 8; x <= 10; ++x) {
    for (int y = 11; y + 1 < kAlong; ++y) {
      const auto length = [&](int along) {
        return grid.unrolled.places[GridWithHole::vertex(x, along)].length;
      };
      EXPECT_LT(length(y), length(y + 1)) << x << ", " << y;
    }
  }
}

TEST(UnrolledLimbs, ACollarWithoutRoomStaysBehind) {
  // Past the end of the grid, which is fixed 0.8 m further up.
  GridWithHole grid(2.0);
  grid.move();
  double least = 1.0;
  for (const CollarPoint& point : grid.collars[0]) {
    least = std::min(least, grid.unrolled.shares[point.vertex]);
    EXPECT_LT(grid.unrolled.places[point.vertex].length, 5.5 + 0.08 * (kAlong / 2));
  }
  EXPECT_LT(least, 0.5);
}

/// The hole becomes an egg that points up the trunk and aside, as for a child that leans along its
/// parent.
TEST(UnrolledLimbs, ACollarThatGrowsToAnEggGoesMoreThanHalfOfTheWay) {
  GridWithHole grid(0.0);
  for (CollarPoint& point : grid.collars[0]) {
    const double up = point.base.length - (5.5 - 0.08);
    point.target.length += up > 0.1 ? 0.45 : 0.0;
    point.target.quarter += up > 0.1 ? 0.3 : 0.0;
  }
  grid.move();
  for (const CollarPoint& point : grid.collars[0]) {
    EXPECT_GT(grid.unrolled.shares[point.vertex], 0.5);
  }
}

TEST(UnrolledLimbs, WhatTurnsWithACollarTurnsBackWithinItsReach) {
  GridWithHole grid(0.0);
  for (CollarPoint& point : grid.collars[0]) point.target.quarter += 0.3;
  // Above the collar's reach, rows are long; an earlier version folded back within one.
  constexpr int kLong = 15;
  for (int y = kLong + 1; y < kAlong; ++y) {
    for (int x = 0; x < kAround; ++x) {
      grid.unrolled.places[GridWithHole::vertex(x, y)].length += y - kLong;
    }
  }
  const UnrolledLimbs before = grid.unrolled;
  grid.move();
  double most = 0.0;
  for (int x = 0; x < kAround; ++x) {
    const int32_t v = GridWithHole::vertex(x, kLong);
    most = std::max(most, grid.unrolled.places[v].quarter - before.places[v].quarter);
  }
  EXPECT_LT(most, 0.06) << "five degrees, of 27";
}

TEST(UnrolledLimbs, CollarsOfForksThatDoNotBlendStay) {
  GridWithHole grid(0.2);
  grid.built.forks[0].blends = false;
  const UnrolledLimbs before = grid.unrolled;
  grid.move();
  for (size_t v = 0; v < before.places.size(); ++v) {
    EXPECT_EQ(grid.unrolled.places[v].length, before.places[v].length);
    EXPECT_EQ(grid.unrolled.shares[v], 0.0);
  }
}

}  // namespace
}  // namespace snowbough::tree
