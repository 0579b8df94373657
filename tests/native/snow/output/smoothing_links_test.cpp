// Smoother across the links between texels: which are open, and seams.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "native/snow/output/plates.h"

namespace snowbough::snow {
namespace {

TEST(SmoothingLinks, chartsThatTouchOnTheMapOnlyAreNotLinked) {
  LaidOutMesh mesh;
  mesh.topology.resolution = 64;
  add_plate(mesh, glm::vec2(0, 0), glm::vec2(0.5f, 1), 0, 1, 1);
  add_plate(mesh, glm::vec2(0.5f, 0), glm::vec2(1, 1), 5, 1, 1);
  const Map map = make_map(std::move(mesh));
  std::vector<float> heights = blanket(map, 1.0f);
  for (size_t i = 0; i < map.table.texel.size(); ++i) {
    if (map.table.chart[i] == 1) heights[map.table.texel[i]] = 0.5f;
  }
  EXPECT_THAT(smooth(map, 0.2f, heights), testing::Pointwise(testing::FloatNear(1e-6f), heights));
}

TEST(SmoothingLinks, bothSidesAreSmoothedSeparatelyAndAlike) {
  const Map map = make_map(cylinder(24, 8, 0.5f, 2.0f, 256));
  std::vector<float> heights = patchy_snow(map, 4);
  const auto positive = smooth(map, 0.03f, heights);
  for (float& h : heights) h = -h;
  auto back = smooth(map, 0.03f, heights);
  for (float& h : back) h = -h;
  EXPECT_EQ(back, positive);
  // Both sides beside each other.
  const Map square = plate(128, 1.28f, 1.28f);
  std::vector<float> both(128 * 128);
  for (size_t i = 0; i < both.size(); ++i) both[i] = i % 128 < 63 ? 0.1f : -0.1f;
  const auto smoothed = smooth(square, 0.05f, both);
  double sum = 0.0;
  for (size_t i = 0; i < both.size(); ++i) {
    ASSERT_GT(smoothed[i] * both[i], 0.0f);
    if (both[i] > 0.0f) sum += smoothed[i];
  }
  EXPECT_NEAR(sum, 0.1 * 63 * 128, 1e-2);
}

TEST(SmoothingLinks, aSeamIsNoBorder) {
  // The same ridge of snow along the tube, on the seam and far away from it.
  const Map map = make_map(cylinder(48, 16, 0.5f, 2.0f, 320));
  const auto column_angle = [](int32_t column) {
    return 6.2831853f * ((static_cast<float>(column) + 0.5f) / 320.0f - 0.1f) / 0.8f;
  };
  const auto profile = [&](float centre) {
    std::vector<float> heights = blanket(map, 0.0f);
    for (const int32_t texel : map.table.texel) {
      const float off = std::remainder(column_angle(texel % 320) - centre, 6.2831853f);
      heights[texel] = 0.05f + (std::abs(off) < 0.2f ? 0.15f : 0.0f);
    }
    const auto smoothed = smooth(map, 0.02f, heights);
    std::vector<float> around;
    for (float off = -0.6f; off < 0.6f; off += 0.05f) {
      const float angle = centre + off < 0.0f ? centre + off + 6.2831853f : centre + off;
      const float at = (angle / 6.2831853f * 0.8f + 0.1f) * 320.0f - 0.5f;
      // Interpolated between two columns that both belong to the tube.
      const auto left = std::clamp(static_cast<int32_t>(std::floor(at)), 32, 286);
      const float part = std::clamp(at - static_cast<float>(left), 0.0f, 1.0f);
      around.push_back((1 - part) * smoothed[160 * 320 + left] +
                       part * smoothed[160 * 320 + left + 1]);
    }
    return around;
  };
  const auto away = profile(3.1415927f);
  const auto seam = profile(0.0f);
  for (size_t k = 0; k < away.size(); ++k) EXPECT_NEAR(seam[k], away[k], 4e-3f) << k;
}

/// The strip's columns in order, across the cut, in its middle row.
std::vector<float> across_the_cut(const std::vector<float>& heights) {
  const float* const row = &heights[16 * 64];
  std::vector<float> columns(row + 8, row + 24);
  columns.insert(columns.end(), row + 40, row + 56);
  return columns;
}

/// `left` on the strip's one half, `right` on the other.
std::vector<float> in_halves(const Map& map, float left, float right) {
  std::vector<float> heights = blanket(map, right);
  for (const int32_t texel : map.table.texel) {
    if (texel % 64 < 32) heights[static_cast<size_t>(texel)] = left;
  }
  return heights;
}

/// The same row of the same strip where it is one chart: `left` on its first 16 columns.
std::vector<float> uncut(float radius, float left, float right) {
  LaidOutMesh mesh;
  mesh.topology.resolution = 64;
  add_plate(mesh, glm::vec2(8.0f / 64), glm::vec2(40.0f, 24.0f) / 64.0f, 0, 2, 1);
  const Map whole = make_map(std::move(mesh));
  std::vector<float> heights = blanket(whole, right);
  for (const int32_t texel : whole.table.texel) {
    if (texel % 64 < 24) heights[static_cast<size_t>(texel)] = left;
  }
  const std::vector<float> smoothed = smooth(whole, radius, heights);
  return {&smoothed[16 * 64 + 8], &smoothed[16 * 64 + 40]};
}

TEST(SmoothingLinks, carryAsMuchAcrossASeamAsWithinAChart) {
  const std::vector<float> within = uncut(0.05f, 0.1f, 0.2f);
  ASSERT_GT(within[15], 0.12f);  // something has crossed
  const Map strip = cut_strip();
  EXPECT_THAT(across_the_cut(smooth(strip, 0.05f, in_halves(strip, 0.1f, 0.2f))),
              testing::Pointwise(testing::FloatNear(1e-6f), within));
}

TEST(SmoothingLinks, acrossASeamAreClosedBetweenDeepSnowAndDust) {
  const Map strip = cut_strip();
  const auto columns = across_the_cut(smooth(strip, 0.1f, in_halves(strip, 0.2f, 1e-4f)));
  for (size_t x = 16; x < 32; ++x) EXPECT_NEAR(columns[x], 1e-4f, 1e-8f) << "column " << x;
  EXPECT_THAT(columns, testing::Pointwise(testing::FloatNear(1e-6f), uncut(0.1f, 0.2f, 1e-4f)));
}

TEST(SmoothingLinks, acrossASeamAreClosedBetweenTheSides) {
  const Map strip = cut_strip();
  const auto smoothed = smooth(strip, 0.05f, in_halves(strip, 0.1f, -0.05f));
  double positive = 0.0;
  double back = 0.0;
  for (const int32_t texel : strip.table.texel) {
    const float height = smoothed[static_cast<size_t>(texel)];
    ASSERT_EQ(height > 0.0f, texel % 64 < 32);
    (height > 0.0f ? positive : back) += height;
  }
  EXPECT_NEAR(positive, 0.1 * 256, 1e-4);
  EXPECT_NEAR(back, -0.05 * 256, 1e-4);
}

}  // namespace
}  // namespace snowbough::snow
