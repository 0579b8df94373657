#include "snow/seams/surface_metric.h"

#include <gtest/gtest.h>

#include "native/snow/seams/squares.h"

namespace snowbough::snow {
namespace {

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
