#include "render/tree/snow_pages.h"

#include <gtest/gtest.h>

#include <glm/vec2.hpp>
#include <vector>

#include "gpu/gpu_thread.h"
#include "shaders/lib/map_tiles.h"

namespace snowbough::render {
namespace {

using glm::ivec2;
using glm::ivec4;

/// A map over two pages, deep at three texels, on either side.
struct Map {
  static constexpr int32_t kWidth = shared::kSnowPage + 3, kHeight = 2 * shared::kSnowTile;
  std::vector<float> heights = std::vector<float>(kWidth * kHeight, 0.0f);
  Map() {
    heights[kWidth - 1] = 0.25f;
    heights[(kHeight - 1) * kWidth + shared::kSnowTile] = -0.5f;
  }
};

void expect_tiles(SnowPages& pages, const ivec4& map) {
  pages.find_depths();
  const auto tiles = pages.tile_depths().read_all<float>();
  const auto depth = [&](int x, int y) {
    return tiles[static_cast<size_t>(shared::snow_tile(ivec2(x, y), map))];
  };
  EXPECT_EQ(depth(shared::kPageTiles, 0), 0.25f);
  EXPECT_EQ(depth(1, 1), 0.5f);
  EXPECT_EQ(depth(0, 0), 0.0f);
  EXPECT_EQ(depth(1, 0), 0.0f);
}

TEST(SnowPages, tilesKnowTheirDeepestOnEitherSide) {
  gpu::GpuThread::shared("")->run([] {
    const Map source;
    SnowPages pages;
    const ivec4 map = pages.add(Map::kWidth, Map::kHeight);
    pages.write(map, source.heights.data());
    expect_tiles(pages, map);
  });
}

TEST(SnowPages, mapsStayWhenOthersComeAndGo) {
  gpu::GpuThread::shared("")->run([] {
    const Map source;
    SnowPages pages;
    const ivec4 full = pages.add(shared::kSnowPage, shared::kSnowPage);
    pages.write(full, std::vector<float>(shared::kSnowPage * shared::kSnowPage, 9.0f).data());
    gpu::Texture shared_map(GL_R32F, Map::kWidth, Map::kHeight, 0, GL_LINEAR);
    shared_map.write(0, GL_RED, GL_FLOAT, source.heights.data());
    const ivec4 copied = pages.add(Map::kWidth, Map::kHeight);
    pages.copy(copied, shared_map);
    pages.remove(full);
    const ivec4 wide = pages.add(7 * shared::kSnowPage, 1);
    EXPECT_GE(wide.z, copied.z + 2);
    // A page that was full is empty outside a small map.
    const ivec4 small = pages.add(1, 1);
    EXPECT_EQ(small.z, full.z);
    const float deep = 1.0f;
    pages.write(small, &deep);
    expect_tiles(pages, copied);
    const auto tiles = pages.tile_depths().read_all<float>();
    EXPECT_EQ(tiles[static_cast<size_t>(shared::snow_tile(ivec2(0, 0), small))], 1.0f);
    EXPECT_EQ(tiles[static_cast<size_t>(shared::snow_tile(ivec2(1, 0), small))], 0.0f);
  });
}

}  // namespace
}  // namespace snowbough::render
