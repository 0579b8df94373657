#include "snow/seams/seam_walk.h"

#include <gtest/gtest.h>

#include <functional>

#include "snow/seams/surface_metric.h"

namespace snowbough::snow {
namespace {

constexpr int32_t kResolution = 100;
using Layout = std::function<glm::vec2(glm::vec2)>;

/// Two square metres that share the edge x = 1: one of x from 0 to 1, which lies on texels 10 to
/// 30, and one of x from 1 to 2, which `other` lays onto the map and `fold` puts elsewhere.
struct Squares {
  MapTopology topology;
  std::vector<glm::vec3> positions;

  explicit Squares(const Layout& other, glm::vec3 fold = {1, 0, 0}) {
    const std::vector<glm::vec2> flat{{0, 0}, {1, 0}, {1, 1}, {0, 1}, {2, 0}, {2, 1}};
    for (const glm::vec2 p : flat) {
      positions.push_back(p.x <= 1.0f ? glm::vec3(p, 0.0f) : glm::vec3(1, p.y, 0) + fold);
    }
    topology.resolution = kResolution;
    topology.vertex_count = 6;
    topology.triangles = {0, 1, 2, 0, 2, 3, 1, 4, 5, 1, 5, 2};
    for (size_t i = 0; i < topology.triangles.size(); ++i) {
      const glm::vec2 p = flat[topology.triangles[i]];
      topology.corner_uv.push_back(i < 6 ? 0.1f + 0.2f * p : other(p));
    }
  }

  SeamWalk walk() const { return {topology, find_charts(topology), positions}; }
};

/// Turned by a quarter and twice as fine.
glm::vec2 turned(glm::vec2 p) {
  return {0.9f - 0.4f * p.y, 0.1f + 0.4f * p.x};
}

/// Seen from behind, and four times as fine along x as along y.
glm::vec2 mirrored(glm::vec2 p) {
  return {0.5f + 0.1f * p.y, 0.1f + 0.4f * p.x};
}

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

TEST(SeamWalk, tellsLinesThatLeaveTheChart) {
  const SeamWalk walk = Squares(turned).walk();
  EXPECT_FALSE(walk.leaves_chart(0, {12, 12}, {28, 27}));
  EXPECT_TRUE(walk.leaves_chart(0, {25, 15}, {35, 15}));
  EXPECT_TRUE(walk.leaves_chart(0, {25, 15}, {25, 35}));
}

TEST(SurfaceMetrics, areTheStepsOfOneTexelOverTheSurface) {
  const Squares squares(mirrored, {0, 0, 1});
  const auto metrics = surface_metrics(squares.topology, squares.positions);
  ASSERT_EQ(metrics.size(), 4u);
  for (const size_t triangle : {0, 1}) {
    EXPECT_NEAR(metrics[triangle].uu, 1.0 / 400, 1e-7);
    EXPECT_NEAR(metrics[triangle].uv, 0.0, 1e-7);
    EXPECT_NEAR(metrics[triangle].vv, 1.0 / 400, 1e-7);
  }
  // u runs along y, ten texels a metre; v along x, forty.
  EXPECT_NEAR(metrics[2].uu, 1.0 / 100, 1e-7);
  EXPECT_NEAR(metrics[2].uv, 0.0, 1e-7);
  EXPECT_NEAR(metrics[2].vv, 1.0 / 1600, 1e-7);
}

TEST(SurfaceMetrics, tellASkewedLayoutByItsMixedTerm) {
  const Squares squares([](glm::vec2 p) { return glm::vec2(0.2f * p.x + 0.1f * p.y, 0.2f * p.y); });
  const auto metrics = surface_metrics(squares.topology, squares.positions);
  // One texel along u is 1/20 m along x; one along v is 1/20 m along y and 1/40 m back along x.
  EXPECT_NEAR(metrics[2].uu, 1.0 / 400, 1e-7);
  EXPECT_NEAR(metrics[2].uv, -1.0 / 800, 1e-7);
  EXPECT_NEAR(metrics[2].vv, 1.0 / 400 + 1.0 / 1600, 1e-7);
}

TEST(SurfaceMetrics, areZeroForATriangleWithoutRoomOnTheMap) {
  const Squares squares([](glm::vec2) { return glm::vec2(0.5f); });
  const auto metrics = surface_metrics(squares.topology, squares.positions);
  EXPECT_EQ(metrics[2].uu, 0.0f);
  EXPECT_EQ(metrics[2].uv, 0.0f);
  EXPECT_EQ(metrics[2].vv, 0.0f);
}

}  // namespace
}  // namespace snowbough::snow
