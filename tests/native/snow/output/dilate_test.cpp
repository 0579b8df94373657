#include "snow/output/dilate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "native/snow/output/plates.h"
#include "native/snow/reference.h"

namespace snowbough::snow {
namespace {

/// The map with one value per owned texel, continued beyond the charts. `filled`: whether all tiles
/// count as filled.
std::vector<float> continued(const Map& map, const std::vector<float>& values, bool filled = true) {
  const auto resolution = static_cast<size_t>(map.table.resolution);
  std::vector<float> shown(resolution * resolution, 0.0f);
  for (size_t i = 0; i < values.size(); ++i) shown[map.table.texel[i]] = values[i];
  const size_t tiles = static_cast<size_t>(MapTiles(map.table.resolution).count());
  MapContinuation(map.table, map.seams).run(shown, std::vector<uint8_t>(tiles, filled));
  return shown;
}

TEST(MapContinuation, continuesTheMapByFourTexels) {
  LaidOutMesh mesh;
  mesh.topology.resolution = 64;
  add_plate(mesh, glm::vec2(0.25f), glm::vec2(0.5f), 0, 1, 1);
  const Map map = make_map(std::move(mesh));
  const auto shown = continued(map, std::vector<float>(map.table.texel.size(), 2.0f));
  const auto at = [&](int x, int y) { return shown[static_cast<size_t>(y) * 64 + x]; };
  EXPECT_EQ(at(16, 20), 2.0f);
  EXPECT_EQ(at(12, 20), 2.0f);
  EXPECT_EQ(at(11, 20), 0.0f);
  EXPECT_EQ(at(35, 35), 2.0f);
  EXPECT_EQ(at(36, 20), 0.0f);
}

TEST(MapContinuation, showsTheOtherSideOfASeamBeyondIt) {
  const Map map = cut_strip();
  std::vector<float> height(map.table.texel.size());
  for (size_t i = 0; i < height.size(); ++i) {
    const int32_t x = map.table.texel[i] % 64;
    height[i] = static_cast<float>(x < 32 ? x - 8 : x - 24);
  }
  const auto shown = continued(map, height);
  for (int k = 0; k < 4; ++k) {
    EXPECT_NEAR(shown[16 * 64 + 24 + k], 16.0f + static_cast<float>(k), 1e-4f);
    EXPECT_NEAR(shown[16 * 64 + 39 - k], 15.0f - static_cast<float>(k), 1e-4f);
  }
}

TEST(MapContinuation, passesOverWhatIsSaidToBeBare) {
  const Map map = make_map(cylinder(24, 8, 0.5f, 2.0f, 256));
  const std::vector<float> values(map.table.texel.size(), 2.0f);
  const auto shown = continued(map, values, false);
  EXPECT_EQ(std::count(shown.begin(), shown.end(), 2.0f), map.table.texel.size());
}

TEST(MapContinuation, agreesWithPlainSumsOverManyTiles) {
  const Map map = make_map(cylinder(24, 8, 0.5f, 2.0f, 256));
  std::vector<float> values(map.table.texel.size());
  std::mt19937 random(11);
  for (float& value : values) value = static_cast<float>(random() % 1000);
  EXPECT_EQ(continued(map, values), dilated(map.table, map.seams, values));
}

}  // namespace
}  // namespace snowbough::snow
