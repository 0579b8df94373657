#include "snow/seams/seam_walk.h"

#include <gtest/gtest.h>

#include "native/snow/seams/squares.h"

namespace snowbough::snow {
namespace {

void expect_near(const glm::dvec2& made, const glm::dvec2& expected) {
  EXPECT_NEAR(made.x, expected.x, 1e-4);
  EXPECT_NEAR(made.y, expected.y, 1e-4);
}

/// Half a metre beyond the seam from x = 0.75, at y = 0.25.
void expect_arrival(const Squares& squares, const glm::dvec2& at, const glm::dvec2& direction) {
  SurfacePoint point{0, {25.0, 15.0}};
  glm::dvec2 ahead(1.0, 0.0);
  ASSERT_TRUE(squares.walk().go(point, {40.0, 15.0}, ahead));
  EXPECT_EQ(point.chart, 1);
  expect_near(point.at, at);
  expect_near(ahead, direction);
}

TEST(SeamWalk, goesOnStraightWhereTheOtherChartIsTurned) {
  expect_arrival(Squares(turned), {80, 70}, {0, 2});
}

TEST(SeamWalk, goesOnStraightWhereTheOtherChartIsMirroredAndStretched) {
  expect_arrival(Squares(mirrored), {52.5, 70}, {0, 2});
}

TEST(SeamWalk, goesOnStraightRoundAnEdge) {
  expect_arrival(Squares(turned, {0, 0, 1}), {80, 70}, {0, 2});
  expect_arrival(Squares(turned, {-0.6f, 0, 0.8f}), {80, 70}, {0, 2});
}

TEST(SeamWalk, staysInItsChartWhereNoSeamLiesBetween) {
  SurfacePoint point{0, {12.0, 12.0}};
  glm::dvec2 ahead(0.0, 1.0);
  ASSERT_TRUE(Squares(turned).walk().go(point, {28.0, 27.0}, ahead));
  EXPECT_EQ(point.chart, 0);
  expect_near(point.at, {28, 27});
  expect_near(ahead, {0, 1});
}

TEST(SeamWalk, endsWhereTheSurfaceEnds) {
  const SeamWalk walk = Squares(turned).walk();
  SurfacePoint point{0, {25.0, 15.0}};
  glm::dvec2 ahead(0.0, 1.0);
  EXPECT_FALSE(walk.go(point, {25.0, 40.0}, ahead));
  point = {0, {25.0, 15.0}};
  ahead = {1.0, 0.0};
  EXPECT_FALSE(walk.go(point, {60.0, 15.0}, ahead)) << "beyond the second square, too";
}

TEST(SeamWalk, endsOnTheWayToATargetFarBeyondTheMap) {
  const SeamWalk walk = Squares(turned).walk();
  for (const glm::dvec2 target : {glm::dvec2(25.0, 1e30), glm::dvec2(25.0, -1e30)}) {
    SurfacePoint point{0, {25.0, 15.0}};
    glm::dvec2 ahead(0.0, 1.0);
    EXPECT_FALSE(walk.go(point, target, ahead));
    EXPECT_TRUE(walk.leaves_chart(0, {25.0, 15.0}, target));
  }
}

TEST(SeamWalk, tellsLinesThatLeaveTheChart) {
  const SeamWalk walk = Squares(turned).walk();
  EXPECT_FALSE(walk.leaves_chart(0, {12, 12}, {28, 27}));
  EXPECT_TRUE(walk.leaves_chart(0, {25, 15}, {35, 15}));
  EXPECT_TRUE(walk.leaves_chart(0, {25, 15}, {25, 35}));
}

}  // namespace
}  // namespace snowbough::snow
