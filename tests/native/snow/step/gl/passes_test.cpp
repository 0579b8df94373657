// The passes of a snow step, one by one: small buffers in, one pass, read back, compare.
#include "snow/step/gl/passes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "gpu/gpu_thread.h"
#include "native/snow/bench.h"
#include "snow/step/gl/scene_buffers.h"

namespace snowbough::snow {
namespace {

TEST(Occlusion, TilesOfEverySizeLieRowByRow) {
  gpu::GpuThread::shared()->run([] {
    Bench bench(objects_of(square("a", 1.0f, 0.0f)), falling({0, 0, -1}, 1.0 / 64.0));
    const std::vector<shared::SeenPixel> whole = bench.visible();
    const PixelRect all = bench.tiles[0].pixels;
    // The same target, now too large for its tile: rows of 20 pixels.
    Tile part = bench.tiles[0];
    part.pixels = {all.low + glm::ivec2(10, 5), all.low + glm::ivec2(30, 50)};
    OcclusionPass().run(bench.scene, bench.projection, part, {{0, bench.scene.triangle_count}},
                        bench.target);
    const std::vector<shared::SeenPixel> visible = bench.visible_in(part);
    for (int32_t y = 0; y < 45; ++y) {
      for (int32_t x = 0; x < 20; ++x) {
        const auto at = static_cast<size_t>(y * 20 + x);
        const auto there = static_cast<size_t>((y + 5) * all.size().x + x + 10);
        EXPECT_EQ(visible[at].triangle, whole[there].triangle);
        EXPECT_EQ(visible[at].depth, whole[there].depth);
      }
    }
  });
}

/// The groups that a list names, sorted.
std::vector<uint32_t> listed(const gpu::Buffer& list) {
  const auto all = list.read_all<uint32_t>();
  std::vector<uint32_t> groups(all.begin() + 8, all.begin() + 8 + all[1]);
  EXPECT_EQ(all[0], shared::kBlocksAGroup);
  EXPECT_EQ(all[5], all[1]);
  std::sort(groups.begin(), groups.end());
  return groups;
}

TEST(TexelGroups, AreInactiveIfTheyFaceAwayAndHoldNoSnow) {
  gpu::GpuThread::shared()->run([] {
    Bench bench(objects_of(plate()), falling({0, 0, -1}, 0.1));
    TexelBatch& batch = bench.scene.batches[0];
    ASSERT_EQ(batch.group_count(), 4);
    TexelGroupsPass groups;
    groups.run(bench.scene, false);
    // Not yet tested for snow.
    EXPECT_EQ(listed(batch.active_groups), (std::vector<uint32_t>{0, 1, 2, 3}));
    StabilityPass().run(bench.scene, {}, 0.01f, 1.0f);
    groups.run(bench.scene, false);
    EXPECT_EQ(listed(batch.active_groups), (std::vector<uint32_t>{0, 1}));
    groups.run(bench.scene, true);
    EXPECT_EQ(listed(batch.active_groups), (std::vector<uint32_t>{0, 1, 2, 3}));
  });
}

TEST(TexelGroups, AreActiveWhileTheyHoldSnow) {
  gpu::GpuThread::shared()->run([] {
    Bench bench(objects_of(plate()), falling({0, 0, -1}, 0.1));
    TexelBatch& batch = bench.scene.batches[0];
    std::vector<float> heights(64 * 64, 0.0f);
    heights[10 * 64 + 40] = 0.1f;  // on the lower side, in the lower half of the map
    bench.scene.groups[0].write_height(0, heights);
    TexelGroupsPass groups;
    groups.run(bench.scene, false);
    StabilityPass().run(bench.scene, {}, 0.01f, 0.01f);
    groups.run(bench.scene, false);
    EXPECT_EQ(listed(batch.active_groups), (std::vector<uint32_t>{0, 1, 2}));
    // It slides off within a thousand half-lives.
    StabilityPass().run(bench.scene, {}, 0.01f, 2000.0f);
    groups.run(bench.scene, false);
    EXPECT_EQ(listed(batch.active_groups), (std::vector<uint32_t>{0, 1}));
  });
}

TEST(WorkGroupSize, ChangesNoResult) {
  gpu::GpuThread::shared()->run([] {
    std::vector<std::vector<float>> heights;
    std::vector<shared::ObjectSums> sums;
    for (const int32_t local_size : {8, 64}) {
      Bench bench(objects_of(square("a", 1.0f, 0.0f, 128), square("b", 0.4f, 0.3f, 64)),
                  falling({0.3, 0, -1}, 1.0 / 200.0));
      StatisticsPass statistics(local_size);
      statistics.open(bench.scene);
      BackPixelsPass(local_size).run(bench.scene, bench.tiles[0], bench.target);
      DepositPass().run(bench.scene, bench.projection, bench.tiles[0], bench.target, false, true);
      StabilityPass(local_size).run(bench.scene, {}, 0.01f, 1.0f);
      const MapGroup& group =
          bench.scene.groups[static_cast<size_t>(bench.scene.layout.plan.group[0])];
      heights.emplace_back(128 * 128);
      group.height.read(0, GL_RED, GL_FLOAT, 128 * 128 * 4, heights.back().data());
      statistics.close(bench.scene, 1.0f);
      sums.push_back(bench.scene.sums.read_all<shared::ObjectSums>()[static_cast<size_t>(
          bench.scene.layout.plan.slot[0])]);
    }
    EXPECT_EQ(heights[0], heights[1]);
    EXPECT_NEAR(sums[0].visible_area, sums[1].visible_area, 1e-5);
    // The part below the smaller square is hidden; areas are perpendicular to the fall.
    EXPECT_NEAR(sums[0].visible_area, (1.0 - 0.4 * 0.4) / std::sqrt(1.09), 0.005);
    // These are added up in floats first.
    EXPECT_NEAR(sums[0].deposited, sums[1].deposited, 1e-5 * sums[0].deposited);
    EXPECT_NEAR(sums[0].deposited, 0.01 * (1.0 - 0.4 * 0.4) / std::sqrt(1.09), 1e-4);
  });
}

TEST(Program, NamesAnInputThatIsMissingOrUnknown) {
  gpu::GpuThread::shared()->run([] {
    gpu::Program program({"triangle_setup.comp.glsl"});
    program.use();
    EXPECT_THROW(program.set("no_such_uniform", 1.0f), std::invalid_argument);
    EXPECT_THROW(program.bind("NoSuchBlock", gpu::Buffer(16)), std::invalid_argument);
    program.set("first", 0u);
    try {
      program.dispatch(1);
      FAIL() << "must throw";
    } catch (const std::logic_error& error) {
      EXPECT_NE(std::string(error.what()).find("'Projection'"), std::string::npos) << error.what();
    }
  });
}

}  // namespace
}  // namespace snowbough::snow
