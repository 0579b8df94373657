#include "gpu/resources.h"

#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "gpu/gpu_thread.h"

namespace snowbough::gpu {
namespace {

TEST(Resources, BufferReturnsWhatItWasGiven) {
  const auto gpu = GpuThread::shared();
  gpu->run([] {
    const std::vector<int32_t> values = {1, -2, 3, 4, 5};
    Buffer buffer(values);
    EXPECT_EQ(buffer.read_all<int32_t>(), values);
    buffer.clear();
    EXPECT_EQ(buffer.read_all<int32_t>(), std::vector<int32_t>(5, 0));
  });
}

TEST(Resources, buffersCountTheirBytesWhileTheyExist) {
  GpuThread::shared()->run([] {
    const int64_t before = buffer_bytes();
    {
      Buffer buffer(100);
      buffer = Buffer(40);
      Buffer moved = std::move(buffer);
      EXPECT_EQ(buffer_bytes(), before + 40);
    }
    EXPECT_EQ(buffer_bytes(), before);
  });
}

TEST(Resources, TextureLayersAreApart) {
  const auto gpu = GpuThread::shared();
  gpu->run([] {
    Texture texture(GL_R32F, 2, 2, 3);
    const std::vector<float> values = {1.0f, 2.0f, 3.0f, 4.0f};
    texture.write(1, GL_RED, GL_FLOAT, values.data());
    std::vector<float> read(4, -1.0f);
    texture.read(1, GL_RED, GL_FLOAT, 16, read.data());
    EXPECT_EQ(read, values);
    texture.read(2, GL_RED, GL_FLOAT, 16, read.data());
    EXPECT_EQ(read, std::vector<float>(4, 0.0f));
  });
}

TEST(Resources, RowsOfALayerAreWrittenAlone) {
  const auto gpu = GpuThread::shared();
  gpu->run([] {
    Texture texture(GL_R32F, 2, 3, 2);
    const std::vector<float> rows = {1.0f, 2.0f, 3.0f, 4.0f};
    texture.write_rows(1, 1, 2, GL_RED, GL_FLOAT, rows.data());
    std::vector<float> read(6, -1.0f);
    texture.read(1, GL_RED, GL_FLOAT, 24, read.data());
    EXPECT_EQ(read, (std::vector<float>{0.0f, 0.0f, 1.0f, 2.0f, 3.0f, 4.0f}));
    texture.read(0, GL_RED, GL_FLOAT, 24, read.data());
    EXPECT_EQ(read, std::vector<float>(6, 0.0f));
  });
}

}  // namespace
}  // namespace snowbough::gpu
