// The kernels that software renderers run on the processor (deposit_kernel, settle_kernel) against
// their shaders, and the batches of texels that both work on.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include "gpu/buffer_writer.h"
#include "snow/step/gl/texel_groups.h"
#include "snow_bench.h"

namespace snowbough::snow {
namespace {

TEST(ProcessorKernels, GiveTheBitsOfTheirShaders) {
  gpu::GpuThread::shared()->run([] {
    if (where_kernels_run().size() < 2) GTEST_SKIP() << "no software renderer";
    // A plate over a slope over the edge of a third; pixels above and below a texel's size, and
    // noise.
    for (const double pixel_size : {1.0 / 20.0, 1.0 / 90.0, 1.0 / 250.0}) {
      for (const float noise_density : {1.0f, 0.4f}) {
        std::vector<std::vector<uint32_t>> steps;
        std::vector<std::vector<float>> heights;
        std::vector<glm::vec4> sums;
        std::vector<std::vector<uint32_t>> states;
        for (const bool on_processor : {false, true}) {
          FallSettings fall = falling({0.3, -0.2, -1}, pixel_size);
          fall.noise_density = noise_density;
          Bench bench(objects_of(square("a", 1.0f, 0.0f, 128), plate()), fall, on_processor);
          TexelGroupsPass().run(bench.scene, false);
          // As if the tile had been one of several.
          for (const bool is_first : {true, false}) {
            DepositPass().run(bench.scene, bench.fall, bench.tiles[0], bench.target,
                              noise_density < 1.0f, is_first);
          }
          StabilityPass().run(bench.scene, {0.015f, 2.0f}, 0.01f / noise_density, 0.5f);
          steps.emplace_back();
          states.emplace_back();
          sums.emplace_back(0.0f);
          for (const TexelBatch& batch : bench.scene.batches) {
            const auto words = batch.steps.read_all<uint32_t>();
            steps.back().insert(steps.back().end(), words.begin(), words.end());
            const auto flags = batch.group_states.read_all<uint32_t>();
            states.back().insert(states.back().end(), flags.begin(), flags.end());
            for (const glm::vec4& sum : batch.partials.read_all<glm::vec4>()) sums.back() += sum;
          }
          heights.emplace_back();
          const MapGroup& group = bench.scene.groups.back();
          group.read_height(group.layers() - 1, heights.back());
        }
        ASSERT_EQ(steps[0].size(), steps[1].size());
        for (size_t i = 0; i < steps[0].size(); ++i) {
          if (i % 4 == 0) {  // gains: places in pixels are rounded to 1e-5 of one
            EXPECT_NEAR(steps[0][i], steps[1][i], 1e-5 * shared::kGainUnits) << pixel_size;
          } else {
            EXPECT_EQ(steps[0][i], steps[1][i]) << pixel_size;
          }
        }
        EXPECT_EQ(states[0], states[1]) << pixel_size;
        // The drivers' exponential functions differ in their last bits.
        float most = 0.0f;
        for (size_t i = 0; i < heights[0].size(); ++i) {
          EXPECT_NEAR(heights[0][i], heights[1][i], 2e-7f) << pixel_size << " texel " << i;
          most = std::max(most, heights[1][i]);
        }
        EXPECT_GT(most, 0.01f);
        for (int i = 0; i < 4; ++i) EXPECT_NEAR(sums[0][i], sums[1][i], 1e-6f) << i;
      }
    }
  });
}

TEST(TexelBatches, FillUpTheirLastGroupWithTexelsOfNobody) {
  gpu::GpuThread::shared()->run([] {
    SceneObject object = square("a", 1.0f, 0.0f);
    // Half of the map: 64 x 32 texels, and the rim.
    for (glm::vec2& uv : object.description.topology.corner_uv) uv.y *= 0.51f;
    object.table = build_texel_table(object.description.topology);
    const size_t own = object.table.texel.size();
    const size_t fragments = object.table.fragment_share.size();
    ASSERT_NE(own % shared::kTexelGroup, 0u);
    const Bench bench(objects_of(std::move(object)), falling({0, 0, -1}, 0.1));
    const TexelBatch& batch = bench.scene.batches.at(0);
    const auto places = batch.places.read_all<uint32_t>();
    const auto begin = batch.fragment_begin.read_all<uint32_t>();
    ASSERT_EQ(places.size() % shared::kTexelGroup, 0u);
    ASSERT_EQ(begin.size(), places.size() + 1);
    for (size_t i = 0; i < places.size(); ++i) {
      EXPECT_EQ(places[i] == shared::kNowhere, i >= own) << i;
      EXPECT_EQ(begin[i] == begin[i + 1], i >= own) << i;
    }
    // Those without any read one: it lies behind the last.
    EXPECT_EQ(begin.back(), fragments);
    EXPECT_EQ(batch.fragments.read_all<shared::Fragment>().size(), fragments + 1);
  });
}

TEST(BufferWriter, HoldsWhatWasAddedAndNoMore) {
  gpu::GpuThread::shared()->run([] {
    std::vector<uint32_t> wanted(200000);
    std::iota(wanted.begin(), wanted.end(), 7u);
    gpu::BufferWriter<uint32_t> writer(wanted.size() + 5);
    for (size_t at = 0; at < wanted.size(); at += 1000) {
      std::copy_n(wanted.begin() + static_cast<ptrdiff_t>(at), 1000, writer.add(1000));
    }
    EXPECT_EQ(writer.size(), wanted.size());
    EXPECT_THROW(writer.add(6), std::length_error);
    EXPECT_EQ(writer.take().read_all<uint32_t>(), wanted);
  });
}

}  // namespace
}  // namespace snowbough::snow
