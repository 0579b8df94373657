#include "render/draw/map_depths.h"

#include <gtest/gtest.h>

#include <vector>

#include "gpu/gpu_thread.h"
#include "shaders/lib/map_tiles.h"

namespace snowbough::render {
namespace {

TEST(MapDepths, tilesKnowTheirDeepestOnEitherSide) {
  gpu::GpuThread::shared("")->run([] {
    // Three tiles a row, the last of which is cut off, and two rows of them.
    constexpr int32_t kWidth = 2 * shared::kSnowTile + 3, kHeight = 2 * shared::kSnowTile;
    std::vector<float> heights(kWidth * kHeight, 0.0f);
    heights[kWidth - 1] = 0.25f;
    heights[(kHeight - 1) * kWidth + shared::kSnowTile] = -0.5f;
    gpu::Texture map(GL_R32F, kWidth, kHeight, 0, GL_LINEAR);
    map.write(0, GL_RED, GL_FLOAT, heights.data());

    const gpu::Buffer tiles(MapDepths::tile_bytes(map));
    MapDepths depths;
    depths.find_tiles(map, tiles);
    EXPECT_EQ(tiles.read_all<float>(), (std::vector<float>{0, 0, 0.25f, 0, 0.5f, 0}));
  });
}

}  // namespace
}  // namespace snowbough::render
