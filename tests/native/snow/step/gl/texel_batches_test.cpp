// The batches in which texels are uploaded to the GPU.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include "gpu/buffer_writer.h"
#include "native/snow/bench.h"
#include "snow/step/gl/passes.h"

namespace snowbough::snow {
namespace {

TEST(TexelBatches, FillTheirLastGroupWithUnusedTexels) {
  gpu::GpuThread::shared()->run([] {
    SceneObject object = square("a", 1.0f, 0.0f);
    // Half of the map: 64 x 32 texels, and the rim.
    for (glm::vec2& uv : object.description.topology.corner_uv) uv.y *= 0.51f;
    object.table =
        std::make_shared<const TexelTable>(build_texel_table(object.description.topology));
    const size_t own = object.table->texel.size();
    const size_t fragments = object.table->fragment_share.size();
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
    // Texels without fragments read one behind the last.
    EXPECT_EQ(begin.back(), fragments);
    EXPECT_EQ(batch.fragments.read_all<shared::Fragment>().size(), fragments + 1);
  });
}

TEST(BufferWriter, HoldsExactlyTheAddedElements) {
  gpu::GpuThread::shared()->run([] {
    std::vector<uint32_t> wanted(200000);
    std::iota(wanted.begin(), wanted.end(), 7u);
    gpu::BufferWriter<uint32_t> writer(wanted.size() + 5);
    for (size_t at = 0; at < wanted.size(); at += 1000) {
      std::copy_n(wanted.begin() + static_cast<ptrdiff_t>(at), 1000, writer.add(1000));
    }
    EXPECT_EQ(writer.size(), wanted.size());
    EXPECT_THROW(writer.add(6), std::length_error);
    EXPECT_EQ(writer.into_buffer().read_all<uint32_t>(), wanted);
  });
}

}  // namespace
}  // namespace snowbough::snow
