// Smoother at the feet of slopes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "native/snow/output/plates.h"

namespace snowbough::snow {
namespace {

constexpr int32_t kSize = 128;
/// Size of a texel in metres.
constexpr float kTexel = 0.01f;

/// Snow of at most `depth` that rises by `slope` from column 32 on.
std::vector<float> bank(float slope, float depth) {
  std::vector<float> heights(kSize * kSize, 0.0f);
  for (int32_t i = 0; i < kSize * kSize; ++i) {
    heights[i] = std::clamp(slope * kTexel * (static_cast<float>(i % kSize) - 31.5f), 0.0f, depth);
  }
  return heights;
}

/// Steepest slope of the middle row from column `first` to column `last`.
float steepest(const std::vector<float>& heights, int32_t first, int32_t last) {
  float most = 0.0f;
  for (int32_t x = first; x < last; ++x) {
    const float* const at = &heights[kSize / 2 * kSize + x];
    most = std::max(most, std::abs(at[1] - at[0]) / kTexel);
  }
  return most;
}

float middle(const std::vector<float>& heights, int32_t x) {
  return heights[kSize / 2 * kSize + x];
}

TEST(SmoothingBanks, aBankGetsHardlySteeper) {
  const Map map = plate(kSize, kSize * kTexel, kSize * kTexel);
  for (const float slope : {1.2f, 2.0f, 3.0f}) {
    const auto smoothed = smooth(map, 0.005f, bank(slope, 0.25f));
    EXPECT_LT(steepest(smoothed, 30, 100), 1.06f * slope) << "slope " << slope;
  }
}

TEST(SmoothingBanks, aBanksCrestIsRounded) {
  const Map map = plate(kSize, kSize * kTexel, kSize * kTexel);
  const auto heights = bank(2.0f, 0.25f);
  const auto smoothed = smooth(map, 0.005f, heights);
  EXPECT_LT(middle(smoothed, 44), middle(heights, 44) - 0.003f);
  EXPECT_NEAR(volume(map, smoothed) / volume(map, heights), 1.0, 2e-6);
  EXPECT_EQ(middle(smoothed, 31), 0.0f);
}

TEST(SmoothingBanks, aBankThatEndsWhereTheSurfaceDoesGetsHardlySteeper) {
  const Map map = plate(kSize, kSize * kTexel, kSize * kTexel);
  std::vector<float> heights(kSize * kSize);
  for (int32_t i = 0; i < kSize * kSize; ++i) {
    heights[i] = std::min(2.0f * kTexel * (static_cast<float>(i % kSize) + 0.5f), 0.25f);
  }
  EXPECT_LT(steepest(smooth(map, 0.005f, heights), 0, 100), 2.12f);
}

TEST(SmoothingBanks, aRidgeIsRoundedAsEver) {
  const Map map = plate(kSize, kSize * kTexel, kSize * kTexel);
  std::vector<float> heights(kSize * kSize);
  for (int32_t i = 0; i < kSize * kSize; ++i) {
    const float from_crest = std::abs(static_cast<float>(i % kSize) - 63.5f);
    heights[i] = std::max(2.0f * kTexel * (12.0f - from_crest), 0.0f);
  }
  EXPECT_LT(middle(smooth(map, 0.005f, heights), 63), 0.8f * middle(heights, 63));
}

/// A plate of 64 x 128 texels and another that is bent down from its rim by a right angle, in one
/// chart.
Map folded() {
  LaidOutMesh mesh;
  mesh.topology.resolution = kSize;
  mesh.topology.vertex_count = 6;
  const float size = kSize * kTexel;
  mesh.positions = {{0, 0, 0},    {0.5f * size, 0, 0},    {0.5f * size, 0, -0.5f * size},
                    {0, size, 0}, {0.5f * size, size, 0}, {0.5f * size, size, -0.5f * size}};
  mesh.topology.triangles = {0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4};
  for (const int32_t v : mesh.topology.triangles) {
    mesh.topology.corner_uv.emplace_back(0.5f * static_cast<float>(v % 3), v < 3 ? 0.0f : 1.0f);
  }
  return make_map(std::move(mesh));
}

std::vector<glm::vec3> normals_of_folded() {
  return {{0, 0, 1}, {0, 0, 1}, {1, 0, 0}, {1, 0, 0}};
}

TEST(SmoothingBanks, snowThatEndsAtARimKeepsItsRoundShoulder) {
  const Map map = folded();
  std::vector<float> heights(kSize * kSize, 0.0f);
  for (int32_t i = 0; i < kSize * kSize; ++i) {
    const float from_rim = 63.5f - static_cast<float>(i % kSize);
    heights[i] = std::clamp(2.0f * kTexel * from_rim, 0.0f, 0.25f);
  }
  const SmoothingGrid flat = build_smoothing_grid(map.table, map.seams);
  const SmoothingGrid bent = build_smoothing_grid(map.table, map.seams, normals_of_folded());
  auto as_bank = heights;
  Smoother(flat, {0.005f}, 2).run(as_bank);
  auto at_rim = heights;
  Smoother(bent, {0.005f}, 2).run(at_rim);
  // Around the former kink, 12 texels from the rim.
  EXPECT_LT(middle(at_rim, 51), middle(as_bank, 51) - 0.01f);
}

TEST(SmoothingGrid, knowsWhereTheSurfaceEndsAndWhereItTurnsAway) {
  const Map map = folded();
  const SmoothingGrid grid = build_smoothing_grid(map.table, map.seams, normals_of_folded());
  const auto end = [&](int32_t x) { return grid.end[kSize / 2 * kSize + x]; };
  EXPECT_EQ(end(0), SurfaceEnd::kOpen);
  EXPECT_EQ(end(30), SurfaceEnd::kNone);
  EXPECT_EQ(end(63), SurfaceEnd::kRim);
  EXPECT_EQ(end(64), SurfaceEnd::kRim);
  EXPECT_EQ(build_smoothing_grid(map.table, map.seams).end[kSize / 2 * kSize + 63],
            SurfaceEnd::kNone);
}

}  // namespace
}  // namespace snowbough::snow
