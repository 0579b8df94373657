// The passes of a snow step, one by one: small buffers in, one pass, read back, compare.
#include "snow/step/gl/passes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "gpu/gpu_thread.h"
#include "native/snow/bench.h"
#include "native/snow/layouts.h"
#include "snow/scene/memory_estimate.h"
#include "snow/seams/seam_leveller.h"
#include "snow/simulation.h"
#include "snow/step/gl/scene_buffers.h"

namespace snowbough::snow {
namespace {

TEST(FallGrid, AxesAreAcrossTheFallAndPointToTheSky) {
  for (const glm::dvec3 direction :
       {glm::dvec3(0, 0, -1), glm::dvec3(1, 0, -1), glm::dvec3(0, 57, -1), glm::dvec3(-3, 1, -2)}) {
    const shared::ProjectionFrame frame = make_projection_frame(falling(direction, 0.5), Bounds{});
    const glm::vec3 x(frame.grid_x);
    const glm::vec3 y(frame.grid_y);
    EXPECT_NEAR(glm::length(x), 2.0f, 1e-5f);
    EXPECT_NEAR(glm::dot(x, y), 0.0f, 1e-5f);
    EXPECT_NEAR(glm::dot(glm::cross(x, y) / 4.0f, glm::vec3(frame.direction)), -1.0f, 1e-5f);
  }
}

TEST(FallGrid, IsAnchoredAtTheWorldsOriginWhereverTheSceneLies) {
  // The same world point has the same global pixel for scenes with different middles.
  const FallSettings settings = falling({0.2, 0.3, -1.0}, 0.01);
  const glm::dvec3 point(1.234, -0.567, 0.25);
  glm::dvec2 first;
  for (const double shift : {0.0, 3.0, 700.0}) {
    Bounds bounds;
    bounds.include(point);
    bounds.include(point + glm::dvec3(shift, 2.0 * shift, 0.0));
    const shared::ProjectionFrame frame = make_projection_frame(settings, bounds);
    const glm::dvec3 offset = point - glm::dvec3(glm::vec3(frame.anchor));
    const glm::dvec2 at(glm::dot(offset, glm::dvec3(glm::vec3(frame.grid_x))) +
                            shared::anchor_pixel(frame).x + frame.base.x,
                        glm::dot(offset, glm::dvec3(glm::vec3(frame.grid_y))) +
                            shared::anchor_pixel(frame).y + frame.base.y);
    if (shift == 0.0) {
      first = at;
    }
    EXPECT_NEAR(at.x, first.x, 0.02) << shift;
    EXPECT_NEAR(at.y, first.y, 0.02) << shift;
  }
}

TEST(FallGrid, JitterFillsThePixelEvenly) {
  int quarters[4] = {0, 0, 0, 0};
  for (uint32_t step = 0; step < 64; ++step) {
    const glm::dvec2 jitter = grid_jitter(5, step);
    ASSERT_GE(jitter.x, 0.0);
    ASSERT_LT(jitter.x, 1.0);
    ++quarters[(jitter.x < 0.5 ? 0 : 1) + (jitter.y < 0.5 ? 0 : 2)];
  }
  for (const int count : quarters) {
    EXPECT_NEAR(count, 16, 2);
  }
}

TEST(FallGrid, FlutterStaysInItsConeAndBelowTheHorizon) {
  const double cone = 3.0 * std::numbers::pi / 180.0;
  const glm::dvec3 steep = glm::normalize(glm::dvec3(57.0, 0.0, -1.0));
  for (uint32_t step = 0; step < 50; ++step) {
    const glm::dvec3 down = flutter_direction({0, 0, -1}, cone, 1, step);
    EXPECT_LE(std::acos(-down.z), cone + 1e-9);
    EXPECT_LT(flutter_direction(steep, cone, 1, step).z, -0.0087);
  }
}

TEST(FallGrid, TilesCoverEveryReceiverOnceAndLeaveOutEmptySky) {
  const std::vector<Tile> tiles = make_tiles({{{0, 0}, {100, 50}}, {{5000, 0}, {5100, 50}}}, 64);
  int64_t pixels = 0;
  for (const Tile& tile : tiles) {
    pixels += int64_t{tile.pixels.size().x} * tile.pixels.size().y;
  }
  EXPECT_EQ(pixels, 2 * 100 * 50);
  EXPECT_THROW(make_tiles({{{0, 0}, {70000, 10}}}, 64), std::invalid_argument);
}

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

/// What texels gain in the bench's first tile.
std::vector<shared::TexelStep> gathered(Bench& bench, bool has_noise = false) {
  DepositPass().run(bench.scene, bench.projection, bench.tiles[0], bench.target, has_noise, true);
  return bench.scene.batches[0].steps.read_all<shared::TexelStep>();
}

TEST(Deposit, IsTheCosineEverywhereOnAPlaneWhateverThePixels) {
  gpu::GpuThread::shared()->run([] {
    {
      for (const double pixel_size : {1.0 / 250.0, 1.0 / 90.0, 1.0 / 64.0, 1.0 / 20.0}) {
        Bench bench(objects_of(square("a", 1.0f, 0.0f)), falling({0.75, 0, -1}, pixel_size));
        for (const shared::TexelStep& step : gathered(bench)) {
          EXPECT_NEAR(step.gain / shared::kGainUnits, 0.8, 1e-6) << pixel_size;
        }
      }
    }
  });
}

TEST(Deposit, AtGrazingFallIsTheCosineStill) {
  gpu::GpuThread::shared()->run([] {
    const double angle = 89.0 * std::numbers::pi / 180.0;
    Bench bench(objects_of(square("a", 1.0f, 0.0f)),
                falling({std::sin(angle), 0, -std::cos(angle)}, 0.002));
    for (const shared::TexelStep& step : gathered(bench)) {
      EXPECT_NEAR(step.gain / shared::kGainUnits, std::cos(angle), 1e-6);
    }
  });
}

/// The gain of the 64 x 64 map's texel at a column and row.
float gain_at(const Bench& bench, const std::vector<shared::TexelStep>& steps, int32_t column,
              int32_t row) {
  const auto places = bench.scene.batches[0].places.read_all<uint32_t>();
  const auto found =
      std::find(places.begin(), places.end(), static_cast<uint32_t>(row * 64 + column));
  return static_cast<float>(steps[static_cast<size_t>(found - places.begin())].gain) /
         shared::kGainUnits;
}

TEST(Deposit, IsNoneBelowARoofAndWholeBesideIt) {
  gpu::GpuThread::shared()->run([] {
    {
      Bench bench(objects_of(square("a", 1.0f, 0.0f), square("roof", 0.5f, 2.0f, 64, false)),
                  falling({0, 0, -1}, 1.0 / 64.0));
      const auto steps = gathered(bench);
      EXPECT_EQ(gain_at(bench, steps, 32, 32), 0.0f);
      EXPECT_EQ(gain_at(bench, steps, 18, 32), 0.0f);
      EXPECT_EQ(gain_at(bench, steps, 13, 32), 1.0f);
      EXPECT_EQ(gain_at(bench, steps, 2, 60), 1.0f);
    }
  });
}

TEST(Deposit, IsNoneUnderAClothThatLiesCloserThanAPixel) {
  gpu::GpuThread::shared()->run([] {
    for (const glm::dvec3 direction : {glm::dvec3(0, 0, -1), glm::dvec3(0.6, 0, -1)}) {
      Bench bench(objects_of(square("a", 1.0f, 0.0f), square("cloth", 0.5f, 0.001f, 64, false)),
                  falling(direction, 1.0 / 64.0));
      const auto steps = gathered(bench);
      EXPECT_EQ(gain_at(bench, steps, 32, 32), 0.0f);
      EXPECT_EQ(gain_at(bench, steps, 20, 40), 0.0f);
      EXPECT_GT(gain_at(bench, steps, 4, 32), 0.8f);
    }
  });
}

TEST(Deposit, OfAStripThinnerThanAPixelIsItsOwnShare) {
  gpu::GpuThread::shared()->run([] {
    for (const float width : {0.3f, 0.05f}) {
      SceneObject twig = square("a", 1.0f, 1.0f);
      for (glm::vec3& point : twig.positions) point.y *= width / 64.0f;
      Bench bench(objects_of(std::move(twig), square("ground", 4.0f, 0.0f, 64, false)),
                  falling({0, 0, -1}, 1.0 / 64.0));
      for (const shared::TexelStep& step : gathered(bench)) {
        EXPECT_NEAR(step.gain / shared::kGainUnits, 1.0, 1e-6) << width;
      }
    }
  });
}

TEST(Deposit, OfTexelsLargerThanPixelsIsThePartOfThemThatIsLit) {
  gpu::GpuThread::shared()->run([] {
    // Texels of 8 pixels; the roof's edge cuts through them at a quarter.
    SceneObject roof = square("roof", 1.0f, 2.0f, 64, false);
    for (glm::vec3& point : roof.positions) point.x -= 0.5f - 0.25f / 64.0f;
    Bench bench(objects_of(square("a", 1.0f, 0.0f), std::move(roof)),
                falling({0, 0, -1}, 1.0 / 512.0));
    const auto steps = gathered(bench);
    EXPECT_EQ(gain_at(bench, steps, 31, 20), 0.0f);
    EXPECT_NEAR(gain_at(bench, steps, 32, 20), 0.75f, 0.07f);
    EXPECT_FLOAT_EQ(gain_at(bench, steps, 33, 20), 1.0f);
  });
}

TEST(Deposit, OnAFaceThatTurnsAwayIsNone) {
  gpu::GpuThread::shared()->run([] {
    Bench bench(objects_of(plate()), falling({0, 0, -1}, 1.0 / 64.0));
    const auto steps = gathered(bench);
    EXPECT_EQ(gain_at(bench, steps, 10, 20), 1.0f);
    EXPECT_EQ(gain_at(bench, steps, 50, 20), 0.0f);
  });
}

TEST(Deposit, IsTheSameBitsHoweverTheTilesAreCut) {
  gpu::GpuThread::shared()->run([] {
    {
      std::vector<std::vector<uint32_t>> gains;
      for (const int32_t tile_size : {2048, 64}) {
        Bench bench(objects_of(square("a", 1.0f, 0.0f), square("roof", 0.5f, 0.4f)),
                    falling({0.3, 0.2, -1}, 1.0 / 200.0));
        std::vector<PixelRect> rects;
        for (const SceneObject& object : bench.objects) {
          rects.push_back(pixels_of(object.bounds, bench.frame));
        }
        DepositPass deposit;
        OcclusionPass occlusion;
        const std::vector<Tile> tiles = make_tiles(rects, tile_size);
        for (const Tile& tile : tiles) {
          occlusion.run(bench.scene, bench.projection, tile, {{0, bench.scene.triangle_count}},
                        bench.target);
          deposit.run(bench.scene, bench.projection, tile, bench.target, false,
                      &tile == &tiles.front());
        }
        gains.emplace_back();
        for (const auto& step : bench.scene.batches[0].steps.read_all<shared::TexelStep>()) {
          gains.back().push_back(step.gain);
        }
      }
      EXPECT_EQ(gains[0], gains[1]);
      EXPECT_GT(*std::max_element(gains[0].begin(), gains[0].end()), 0u);
    }
  });
}

TEST(Deposit, WithNoiseComesThroughAsManyPixelsAsTheDensitySays) {
  gpu::GpuThread::shared()->run([] {
    FallSettings settings = falling({0, 0, -1}, 1.0 / 64.0);
    settings.noise_density = 0.25;
    Bench bench(objects_of(square("a", 1.0f, 0.0f)), settings);
    double sum = 0.0;
    const auto steps = gathered(bench, true);
    for (const shared::TexelStep& step : steps) sum += step.gain / double(shared::kGainUnits);
    EXPECT_NEAR(sum / static_cast<double>(steps.size()), 0.25, 0.02);
  });
}

TEST(DepositGeometry, PutsEveryPixelsSnowOnTheTexelUnderIt) {
  gpu::GpuThread::shared()->run([] {
    for (const double pixel_size : {1.0 / 300.0, 1.0 / 64.0, 1.0 / 16.0}) {
      Bench bench(objects_of(square("a", 1.0f, 0.0f)), falling({0.3, 0, -1}, pixel_size));
      DepositGeometryPass geometry;
      geometry.begin(bench.scene);
      geometry.run(bench.scene, bench.projection, bench.tiles[0], bench.target);
      std::vector<float> laid(64 * 64);
      bench.scene.groups[0].deposit.read(0, GL_RED, GL_FLOAT, 64 * 64 * 4, laid.data());
      double volume = 0.0;
      for (const float thickness : laid) volume += thickness / (64.0 * 64.0);
      int64_t pixels = 0;
      for (const shared::SeenPixel& pixel : bench.visible()) pixels += pixel.triangle != 0 ? 1 : 0;
      const double thickness = 0.01 * std::sqrt(1.09);  // perpendicular to the fall
      EXPECT_NEAR(volume, static_cast<double>(pixels) * pixel_size * pixel_size * thickness,
                  1e-5 * volume)
          << pixel_size;
    }
  });
}

TEST(Stability, FollowsTheClosedFormBelowAcrossAndAboveCapacity) {
  gpu::GpuThread::shared()->run([] {
    const auto stable_height = [&](float height, float deposit, float dt, float max_depth,
                                   bool is_ceiling = false) {
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
    const double k = std::numbers::ln2 / 2.0;
    {
      EXPECT_FLOAT_EQ(stable_height(0.1f, 0.2f, 1.0f, 0.5f), 0.3f);
      EXPECT_NEAR(stable_height(0.9f, 0.0f, 2.0f, 0.5f), 0.7f, 1e-6);
      EXPECT_NEAR(stable_height(0.5f, 0.3f, 1.0f, 0.5f), 0.5 + 0.3 * (1.0 - std::exp2(-0.5)) / k,
                  1e-6);
      // Crosses at a third of the step.
      EXPECT_NEAR(stable_height(0.4f, 0.3f, 1.0f, 0.5f),
                  0.5 + 0.2 * (1.0 - std::exp2(-1.0 / 3.0)) / (k * 2.0 / 3.0), 1e-6);
      EXPECT_NEAR(stable_height(0.1f, 0.0f, 20.0f, 0.0f), 0.1 * std::exp2(-10.0), 1e-7);
      // Past vertical, but no time to slide: a huge capacity rounds nothing away.
      EXPECT_FLOAT_EQ(stable_height(0.001f, 0.002f, 0.0f, 1e6f, true), 0.003f);
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

TEST(TexelGroups, LeaveOutWhatFacesAwayOnceItIsKnownToBeBare) {
  gpu::GpuThread::shared()->run([] {
    Bench bench(objects_of(plate()), falling({0, 0, -1}, 0.1));
    TexelBatch& batch = bench.scene.batches[0];
    ASSERT_EQ(batch.group_count(), 4);
    TexelGroupsPass groups;
    groups.run(bench.scene, false);
    // Nobody has looked yet whether snow lies there.
    EXPECT_EQ(listed(batch.active_groups), (std::vector<uint32_t>{0, 1, 2, 3}));
    StabilityPass().run(bench.scene, {}, 0.01f, 1.0f);
    groups.run(bench.scene, false);
    EXPECT_EQ(listed(batch.active_groups), (std::vector<uint32_t>{0, 1}));
    groups.run(bench.scene, true);
    EXPECT_EQ(listed(batch.active_groups), (std::vector<uint32_t>{0, 1, 2, 3}));
  });
}

TEST(TexelGroups, KeepThoseOnWhichSnowLies) {
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
    // What the smaller square covers is not seen; areas are measured across the fall.
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

TEST(MapStore, GroupsMapsBySizeAndSplitsLargeArrays) {
  std::vector<SceneObject> objects;
  for (int i = 0; i < 5; ++i) {
    SceneObject object;
    object.description.name = std::string(1, static_cast<char>('a' + i));
    object.description.topology.resolution = i == 2 ? 64 : 8192;
    object.description.receive = i != 4;
    objects.push_back(std::move(object));
  }
  std::vector<const SceneObject*> pointers;
  for (const SceneObject& object : objects) {
    pointers.push_back(&object);
  }
  const MapPlan plan = plan_maps(pointers, 2048);
  EXPECT_EQ(plan.slot, (std::vector<int32_t>{1, 2, 0, 3, 4}));
  // An 8192 map's owner table takes 512 MiB: two an array.
  ASSERT_EQ(plan.groups.size(), 3u);
  EXPECT_EQ(plan.group, (std::vector<int32_t>{1, 1, 0, 2, -1}));
}

TEST(MemoryEstimate, CountsAtLeastWhatLevellingKeeps) {
  SceneObject object;
  LaidOutMesh mesh = cylinder(24, 8, 0.5f, 2.0f, 256);
  for (const bool apart : {false, true}) {
    if (apart) lay_out_apart(mesh, 256);
    object.description.topology = mesh.topology;
    object.table = build_texel_table(mesh.topology);
    const SeamTable seams = build_seam_table(mesh.topology, object.table, mesh.positions);
    SeamLeveller leveller(seams.levelling);
    std::vector<float> map(256 * 256, 0.0f);
    for (size_t i = 0; i < map.size(); ++i) map[i] = 0.01f * static_cast<float>(i * 7 % 13);
    leveller.run(map);
    const int64_t kept =
        leveller.bytes() + 64 * static_cast<int64_t>(seams.levelling.points.size());
    const int64_t estimate = estimate_memory({&object}, 1024).seams;
    EXPECT_GT(estimate, kept);
    EXPECT_LT(estimate, 5 * kept);
  }
}

TEST(MemoryEstimate, RefusesWhatDoesNotFitWithTheFigure) {
  SceneObject object = square("a", 1.0f, 0.0f, 256);
  const MemoryEstimate estimate = estimate_memory({&object}, 1024);
  EXPECT_EQ(estimate.maps, 256 * 256 * 4);
  EXPECT_EQ(estimate_memory({&object}, 1024, true).maps, 256 * 256 * 12);
  EXPECT_GT(estimate.texels, 256 * 256 * 40);
  EXPECT_NO_THROW(require_memory(estimate, int64_t{1} << 32));
  try {
    require_memory(estimate, 1 << 20);
    FAIL() << "must throw";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("1 MiB are free"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("resolution"), std::string::npos);
  }
}

}  // namespace
}  // namespace snowbough::snow
