// The deposit as shaders gather it, and as the mapping Geometry puts it on texels.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <utility>

#include "gpu/gpu_thread.h"
#include "native/snow/bench.h"
#include "snow/step/gl/passes.h"

namespace snowbough::snow {
namespace {

/// Gains of texels in the bench's first tile.
std::vector<shared::TexelStep> gathered(Bench& bench, bool has_noise = false) {
  DepositPass().run(bench.scene, bench.projection, bench.tiles[0], bench.target, has_noise, true);
  return bench.scene.batches[0].steps.read_all<shared::TexelStep>();
}

TEST(Deposit, IsTheCosineEverywhereOnAPlaneWhateverThePixels) {
  gpu::GpuThread::shared()->run([] {
    for (const double pixel_size : {1.0 / 250.0, 1.0 / 90.0, 1.0 / 64.0, 1.0 / 20.0}) {
      Bench bench(objects_of(square("a", 1.0f, 0.0f)), falling({0.75, 0, -1}, pixel_size));
      for (const shared::TexelStep& step : gathered(bench)) {
        EXPECT_NEAR(step.gain / shared::kGainUnits, 0.8, 1e-6) << pixel_size;
      }
    }
  });
}

TEST(Deposit, IsTheCosineAtGrazingFall) {
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

TEST(Deposit, IsZeroBelowARoofAndFullBesideIt) {
  gpu::GpuThread::shared()->run([] {
    Bench bench(objects_of(square("a", 1.0f, 0.0f), square("roof", 0.5f, 2.0f, 64, false)),
                falling({0, 0, -1}, 1.0 / 64.0));
    const auto steps = gathered(bench);
    EXPECT_EQ(gain_at(bench, steps, 32, 32), 0.0f);
    EXPECT_EQ(gain_at(bench, steps, 18, 32), 0.0f);
    EXPECT_EQ(gain_at(bench, steps, 13, 32), 1.0f);
    EXPECT_EQ(gain_at(bench, steps, 2, 60), 1.0f);
  });
}

TEST(Deposit, IsZeroUnderAClothCloserThanAPixel) {
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

TEST(Deposit, OfLargeTexelsIsTheirVisibleShare) {
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

TEST(Deposit, IsZeroOnAFaceThatTurnsAway) {
  gpu::GpuThread::shared()->run([] {
    Bench bench(objects_of(plate()), falling({0, 0, -1}, 1.0 / 64.0));
    const auto steps = gathered(bench);
    EXPECT_EQ(gain_at(bench, steps, 10, 20), 1.0f);
    EXPECT_EQ(gain_at(bench, steps, 50, 20), 0.0f);
  });
}

TEST(Deposit, IsTheSameBitsHoweverTheTilesAreCut) {
  gpu::GpuThread::shared()->run([] {
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
  });
}

TEST(Deposit, WithNoiseReachesTheShareOfPixelsThatTheDensitySets) {
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

TEST(GeometryDeposit, PutsEveryPixelsSnowOnTheTexelUnderIt) {
  gpu::GpuThread::shared()->run([] {
    for (const double pixel_size : {1.0 / 300.0, 1.0 / 64.0, 1.0 / 16.0}) {
      Bench bench(objects_of(square("a", 1.0f, 0.0f)), falling({0.3, 0, -1}, pixel_size));
      GeometryDeposit geometry({bench.objects.data()}, bench.scene);
      geometry.begin();
      geometry.run(bench.scene, bench.projection, bench.tiles[0], bench.target);
      geometry.write_gains(bench.scene);
      double volume = 0.0;
      for (const auto& step : bench.scene.batches[0].steps.read_all<shared::TexelStep>()) {
        volume += std::bit_cast<float>(step.gain) / (64.0 * 64.0);
      }
      int64_t pixels = 0;
      for (const shared::SeenPixel& pixel : bench.visible()) pixels += pixel.triangle != 0 ? 1 : 0;
      const double thickness = 0.01 * std::sqrt(1.09);  // perpendicular to the fall
      EXPECT_NEAR(volume, static_cast<double>(pixels) * pixel_size * pixel_size * thickness,
                  1e-5 * volume)
          << pixel_size;
    }
  });
}

}  // namespace
}  // namespace snowbough::snow
