#include "snow/output/smoothing.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <stdexcept>

#include "native/snow/output/plates.h"

namespace snowbough::snow {
namespace {

/// Standard deviation in metres, along x and y, to which smoothing spreads a little additional snow
/// in the middle of a blanket of the given depth.
glm::dvec2 spread_of(const Map& map, float radius, float depth) {
  const int32_t size = map.table.resolution;
  std::vector<float> heights = blanket(map, depth);
  const int32_t middle = size / 2;
  heights[static_cast<size_t>(middle) * size + middle] *= 1.5f;
  const std::vector<float> smoothed = smooth(map, radius, heights);
  glm::dvec2 variance(0.0);
  double sum = 0.0;
  for (int32_t y = 0; y < size; ++y) {
    for (int32_t x = 0; x < size; ++x) {
      const double h = double{smoothed[static_cast<size_t>(y) * size + x]} - double{depth};
      const glm::dvec2 d = glm::dvec2(x - middle, y - middle) * glm::dvec2(map.seams.texel_size[0]);
      variance += h * d * d;
      sum += h;
    }
  }
  EXPECT_NEAR(sum, 0.5 * depth, 1e-3 * depth);
  return glm::sqrt(variance / sum);
}

TEST(Smoothing, theRadiusIsInMetres) {
  for (const float texels : {0.5f, 1.0f, 2.0f, 3.0f, 6.0f, 10.0f}) {
    const Map map = plate(128, 12.8f, 12.8f);
    const glm::dvec2 spread = spread_of(map, texels * 0.1f, 0.01f);
    EXPECT_NEAR(spread.x, texels * 0.1, 0.004 * texels);
    EXPECT_NEAR(spread.y, texels * 0.1, 0.004 * texels);
  }
}

TEST(Smoothing, theRadiusGrowsToAThirdOfTheDepth) {
  const Map map = plate(128, 12.8f, 12.8f);
  for (const float depth : {0.6f, 1.5f, 3.0f}) {
    const glm::dvec2 spread = spread_of(map, 0.1f, depth);
    EXPECT_NEAR(spread.x, depth / 3.0, 0.02 * depth);
    EXPECT_NEAR(spread.y, depth / 3.0, 0.02 * depth);
  }
}

TEST(Smoothing, aStretchedLayoutIsSmoothedEvenlyOnTheSurface) {
  const Map map = plate(128, 12.8f, 25.6f);
  const glm::dvec2 spread = spread_of(map, 0.3f, 0.01f);
  EXPECT_NEAR(spread.x, 0.3, 0.03);
  EXPECT_NEAR(spread.y, 0.3, 0.03);
}

TEST(Smoothing, aLevelBlanketStaysLevelUpToItsRim) {
  LaidOutMesh mesh;
  mesh.topology.resolution = 64;
  add_plate(mesh, glm::vec2(0.1f), glm::vec2(0.77f), 0, 1, 1);
  const Map map = make_map(std::move(mesh));
  const auto heights = blanket(map, 0.25f);
  EXPECT_THAT(smooth(map, 0.1f, heights), testing::Pointwise(testing::FloatNear(1e-6f), heights));
}

TEST(Smoothing, aRadiusOfZeroPassesTheMapOn) {
  const Map map = plate(64, 1, 1);
  std::vector<float> heights(64 * 64);
  for (size_t i = 0; i < heights.size(); ++i) heights[i] = static_cast<float>(i % 7);
  EXPECT_EQ(smooth(map, 0.0f, heights), heights);
}

TEST(Smoothing, aNegativeRadiusIsRefused) {
  EXPECT_THROW(check_smoothing({-1.0f}), std::invalid_argument);
  EXPECT_THROW(check_smoothing({std::nanf("")}), std::invalid_argument);
}

TEST(Smoothing, keepsTheVolumeAndLiftsNoBareGroundAcrossSeams) {
  LaidOutMesh apart = cylinder(24, 8, 0.5f, 2.0f, 256);
  lay_out_apart(apart, 256);
  for (LaidOutMesh& mesh : std::array{cylinder(24, 8, 0.5f, 2.0f, 256), apart}) {
    const Map map = make_map(std::move(mesh));
    const auto heights = patchy_snow(map, 3);
    for (const float radius : {0.001f, 0.02f, 0.2f}) {
      const auto smoothed = smooth(map, radius, heights);
      EXPECT_NEAR(volume(map, smoothed) / volume(map, heights), 1.0, 2e-6) << "radius " << radius;
      for (size_t i = 0; i < heights.size(); ++i) {
        ASSERT_EQ(smoothed[i] > 0.0f, heights[i] > 0.0f) << "texel " << i;
      }
    }
  }
}

TEST(Smoothing, doesNotRing) {
  // A step of 20 cm on deep snow: nothing may lie above or below what lay there.
  const Map map = plate(128, 1.28f, 1.28f);
  std::vector<float> heights(128 * 128);
  for (size_t i = 0; i < heights.size(); ++i) heights[i] = i % 128 < 64 ? 0.5f : 0.3f;
  const auto smoothed = smooth(map, 0.02f, heights);
  float before = 1.0f;
  for (size_t x = 0; x < 128; ++x) {
    const float h = smoothed[64 * 128 + x];
    EXPECT_LE(h, before + 1e-6f) << "column " << x;
    EXPECT_GE(h, 0.3f - 1e-6f);
    EXPECT_LE(h, 0.5f + 1e-6f);
    before = h;
  }
  // Round, too: the steepest place is no terrace of the coarse levels.
  for (size_t x = 1; x < 127; ++x) {
    const float* const at = &smoothed[64 * 128 + x];
    EXPECT_LT(std::abs(at[1] - 2 * at[0] + at[-1]), 1.5e-3f) << "column " << x;
  }
}

}  // namespace
}  // namespace snowbough::snow
