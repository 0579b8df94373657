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

TEST(TriangleSetup, HoldsCornersOnTheGridSlopesAndArea) {
  gpu::GpuThread::shared()->run([] {
    Bench bench(objects_of(square("a", 2.0f, 3.0f)), falling({0.75, 0, -1}, 0.1));
    const auto corners = bench.scene.triangle_corners.read_all<glm::vec4>();
    const auto surface = bench.scene.triangle_surface.read_all<glm::vec4>();
    // The fall leans along x: the square's first side is foreshortened and gains depth.
    EXPECT_NEAR(corners[1].x - corners[0].x, 20.0f * 0.8f, 1e-4f);
    EXPECT_NEAR(corners[1].y - corners[0].y, 0.0f, 1e-4f);
    EXPECT_NEAR(corners[1].z - corners[0].z, 2.0f * 0.6f, 1e-5f);
    EXPECT_NEAR(corners[2].y - corners[1].y, 20.0f, 1e-4f);
    EXPECT_NEAR(corners[0].w, 0.1f * 0.6f / 0.8f, 1e-5f);
    EXPECT_NEAR(corners[1].w, 0.0f, 1e-5f);
    EXPECT_NEAR(corners[2].w, 0.8f, 1e-5f);
    EXPECT_NEAR(surface[0].x, 0.8f, 1e-5f);
    EXPECT_NEAR(surface[0].y, 2.0f, 1e-5f);
    EXPECT_NEAR(surface[0].z, 1.0f, 1e-5f);
  });
}

TEST(TexelSurface, HoldsAreaAndUpwardPart) {
  gpu::GpuThread::shared()->run([] {
    Bench bench(objects_of(square("a", 2.0f, 3.0f)), falling({0, 0, -1}, 0.1));
    double area = 0.0;
    for (const auto& texel : bench.scene.batches[0].steps.read_all<shared::TexelStep>()) {
      area += texel.area;
      EXPECT_FLOAT_EQ(texel.up, 1.0f);
    }
    EXPECT_NEAR(area, 4.0, 1e-4);
  });
}

TEST(Occlusion, ShowsTheNearerSurfaceWithItsDepth) {
  gpu::GpuThread::shared()->run([] {
    Bench bench(objects_of(square("ground", 1.0f, 0.0f), square("roof", 0.5f, 2.0f)),
                falling({0, 0, -1}, 0.01));
    int roof = 0;
    int ground = 0;
    for (const shared::SeenPixel& pixel : bench.visible()) {
      if (pixel.triangle == 0) {
        continue;
      }
      const bool is_roof = pixel.triangle > 2;
      EXPECT_NEAR(pixel.depth, is_roof ? -1.0f : 1.0f, 1e-5f);
      (is_roof ? roof : ground) += 1;
    }
    EXPECT_EQ(roof, 2500);
    EXPECT_EQ(ground, 7500);
  });
}

TEST(Occlusion, MarksBackFaces) {
  gpu::GpuThread::shared()->run([] {
    SceneObject flipped = square("a", 1.0f, 0.0f);
    std::swap(flipped.description.topology.triangles[1], flipped.description.topology.triangles[2]);
    std::swap(flipped.description.topology.triangles[4], flipped.description.topology.triangles[5]);
    Bench bench(objects_of(std::move(flipped)), falling({0, 0, -1}, 0.05));
    int shown = 0;
    for (const shared::SeenPixel& pixel : bench.visible()) {
      if (pixel.triangle != 0) {
        EXPECT_NE(pixel.triangle & shared::kBackFace, 0u);
        ++shown;
      }
    }
    EXPECT_EQ(shown, 400);
  });
}

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

TEST(Stability, FollowsTheClosedFormBelowAcrossAndAboveCapacity) {
  gpu::GpuThread::shared()->run([] {
    const auto stable_height = [&](float height, float deposit, float dt, float max_depth,
                                   bool is_ceiling) {
      SceneObject object = square("a", 1.0f, 0.0f);
      if (is_ceiling) {
        std::vector<int32_t>& corners = object.description.topology.triangles;
        std::swap(corners[1], corners[2]);
        std::swap(corners[4], corners[5]);
      }
      Bench bench(objects_of(std::move(object)), falling({0, 0, -1}, 0.1));
      std::vector<float> heights(64 * 64, height);
      bench.scene.groups[0].write_height(0, heights);
      auto steps = bench.scene.batches[0].steps.read_all<shared::TexelStep>();
      for (shared::TexelStep& step : steps) step.gain = 1u << 28;
      bench.scene.batches[0].steps.write(
          0, static_cast<int64_t>(steps.size() * sizeof(shared::TexelStep)), steps.data());
      StabilityPass().run(bench.scene, {max_depth, 2.0f}, deposit, dt);
      bench.scene.groups[0].read_height(0, heights);
      return heights[1000];
    };
    expect_closed_form(stable_height);
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
