// The surface of many texels at once is that of each, to the bit.
#include "snow/movement/repose/surface.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <vector>

namespace snowbough::snow {
namespace {

constexpr int32_t kSize = 64;

/// A wavy square of 5 x 5 cells that fills the map but for a margin: texels within a triangle, with
/// several fragments, and at open edges. One cell has no area.
SceneObject wavy(bool is_smooth) {
  SceneObject object;
  MapTopology& topology = object.description.topology;
  topology.resolution = kSize;
  std::vector<glm::vec2> uv;
  for (int32_t y = 0; y <= 5; ++y) {
    for (int32_t x = 0; x <= 5; ++x) {
      const auto u = static_cast<float>(x);
      const auto v = static_cast<float>(y);
      uv.push_back({0.03f + 0.19f * u, 0.02f + 0.19f * v});
      object.positions.push_back({u, v, std::sin(2.0f * u) * std::cos(1.3f * v)});
    }
  }
  topology.vertex_count = static_cast<int32_t>(uv.size());
  for (int32_t y = 0; y < 5; ++y) {
    for (int32_t x = 0; x < 5; ++x) {
      const int32_t a = 6 * y + x;
      for (const int32_t corner : {a, a + 1, a + 7, a, a + 7, a + 6}) {
        topology.triangles.push_back(corner);
        topology.corner_uv.push_back(uv[static_cast<size_t>(corner)]);
      }
    }
  }
  object.positions[7] = object.positions[14];
  if (is_smooth) object.description.shading = topology.triangles;
  object.two_sided.assign(topology.triangles.size() / 3, 0);
  object.two_sided[20] = 1;
  object.table = std::make_shared<const TexelTable>(build_texel_table(topology));
  return object;
}

struct Planes {
  std::array<std::vector<float>, 7> numbers;
  std::vector<uint8_t> two_sided;

  explicit Planes(size_t count) : two_sided(count) {
    for (std::vector<float>& plane : numbers) plane.resize(count);
  }
  ReposeSurface::Row row() {
    return {numbers[0].data(), numbers[1].data(), numbers[2].data(), numbers[3].data(),
            numbers[4].data(), numbers[5].data(), numbers[6].data(), two_sided.data()};
  }
};

TEST(ReposeSurface, IsTheSameForRowsOfTexelsAsForEach) {
  for (const bool is_smooth : {false, true}) {
    const SceneObject object = wavy(is_smooth);
    ReposeSurface surface;
    surface.set_pose(object, *object.table, object.positions, true);
    const size_t count = object.table->texel.size();
    Planes planes(count);
    surface.texels(0, static_cast<int32_t>(count), planes.row());
    for (size_t i = 0; i < count; ++i) {
      const ReposeSurface::Texel own = surface.texel(static_cast<int32_t>(i));
      const std::array<float, 7> expected = {own.point.x, own.point.y, own.point.z,  own.normal.z,
                                             own.up,      own.area,    own.curvature};
      for (size_t k = 0; k < expected.size(); ++k) {
        ASSERT_EQ(std::bit_cast<uint32_t>(planes.numbers[k][i]),
                  std::bit_cast<uint32_t>(expected[k]))
            << "property " << k << " of texel " << i;
      }
      ASSERT_EQ(planes.two_sided[i] != 0, own.two_sided);
    }
  }
}

/// A face of 60 degrees and a wall below it, in one chart: the fold runs through the middle of the
/// second column of texels.
TEST(ReposeSurface, StandsOnThePartOfATexelThatCarriesSnow) {
  SceneObject object;
  MapTopology& topology = object.description.topology;
  topology.resolution = kSize;
  topology.vertex_count = 6;
  const float fold = 1.5f / static_cast<float>(kSize);
  const float low = -fold * std::sqrt(0.75f);
  for (const float y : {0.0f, 1.0f}) {
    object.positions.push_back({0.0f, y, 0.0f});
    object.positions.push_back({0.5f * fold, y, low});
    object.positions.push_back({0.5f * fold, y, low - 1.0f + fold});
  }
  const std::vector<glm::vec2> uv = {{0, 0}, {fold, 0}, {1, 0}, {0, 1}, {fold, 1}, {1, 1}};
  for (const int32_t corner : {0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4}) {
    topology.triangles.push_back(corner);
    topology.corner_uv.push_back(uv[static_cast<size_t>(corner)]);
  }
  object.table = std::make_shared<const TexelTable>(build_texel_table(topology));
  ReposeSurface surface;
  surface.set_pose(object, *object.table, object.positions, false);
  const ReposeSurface::Texel mixed = surface.texel(1);
  EXPECT_NEAR(mixed.up, 0.5f, 1e-5f);
  EXPECT_NEAR(mixed.normal.z, 0.25f, 1e-5f);
  const ReposeSurface::Texel whole = surface.texel(0);
  EXPECT_NEAR(whole.up, 0.5f, 1e-5f);
  EXPECT_NEAR(whole.normal.z, 0.5f, 1e-5f);
}

}  // namespace
}  // namespace snowbough::snow
