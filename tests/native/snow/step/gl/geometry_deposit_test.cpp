// The deposit that the mapping Geometry puts on texels. What shaders gather is held by the engines'
// agreement, and by tests/python/native/test_snow*.py, which run on both.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "gpu/gpu_thread.h"
#include "native/snow/bench.h"
#include "snow/step/gl/passes.h"

namespace snowbough::snow {
namespace {

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
