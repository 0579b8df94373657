#include "snow/output/dilate.h"

#include <gtest/gtest.h>

#include "native/snow/output/plates.h"

namespace snowbough::snow {
namespace {

/// The map with one value per owned texel, extended beyond the charts.
std::vector<float> extended(const Map& map, const std::vector<float>& values) {
  const auto resolution = static_cast<size_t>(map.table.resolution);
  std::vector<float> shown(resolution * resolution, 0.0f);
  for (size_t i = 0; i < values.size(); ++i) shown[map.table.texel[i]] = values[i];
  dilate_heights(map.table, map.seams, shown);
  return shown;
}

TEST(DilateHeights, continuesTheMapByFourTexels) {
  LaidOutMesh mesh;
  mesh.topology.resolution = 64;
  add_plate(mesh, glm::vec2(0.25f), glm::vec2(0.5f), 0, 1, 1);
  const Map map = make_map(std::move(mesh));
  const auto shown = extended(map, std::vector<float>(map.table.texel.size(), 2.0f));
  const auto at = [&](int x, int y) { return shown[static_cast<size_t>(y) * 64 + x]; };
  EXPECT_EQ(at(16, 20), 2.0f);
  EXPECT_EQ(at(12, 20), 2.0f);
  EXPECT_EQ(at(11, 20), 0.0f);
  EXPECT_EQ(at(35, 35), 2.0f);
  EXPECT_EQ(at(36, 20), 0.0f);
}

TEST(DilateHeights, showsTheOtherSideOfASeamBeyondIt) {
  const Map map = cut_strip();
  std::vector<float> height(map.table.texel.size());
  for (size_t i = 0; i < height.size(); ++i) {
    const int32_t x = map.table.texel[i] % 64;
    height[i] = static_cast<float>(x < 32 ? x - 8 : x - 24);
  }
  const auto shown = extended(map, height);
  for (int k = 0; k < 4; ++k) {
    EXPECT_NEAR(shown[16 * 64 + 24 + k], 16.0f + static_cast<float>(k), 1e-4f);
    EXPECT_NEAR(shown[16 * 64 + 39 - k], 15.0f - static_cast<float>(k), 1e-4f);
  }
}

}  // namespace
}  // namespace snowbough::snow
