#include "gpu/gpu_thread.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

#include "gpu/resources.h"
#include "gpu/shader_source.h"

namespace snowbough::gpu {
namespace {

TEST(GpuThread, RunsClosuresOnItsOwnThread) {
  const auto gpu = GpuThread::shared();
  EXPECT_FALSE(gpu->is_current());
  EXPECT_TRUE(gpu->run([&] { return gpu->is_current(); }));
  EXPECT_EQ(gpu->run([&] { return gpu->run([] { return 7; }); }), 7);
}

TEST(GpuThread, HandsExceptionsToTheCaller) {
  const auto gpu = GpuThread::shared();
  EXPECT_THROW(gpu->run([] { throw std::invalid_argument("bad"); }), std::invalid_argument);
  EXPECT_EQ(gpu->run([] { return 3; }), 3) << "the thread must go on working";
}

TEST(GpuThread, TurnsAGlErrorIntoAnException) {
  const auto gpu = GpuThread::shared();
  EXPECT_THROW(gpu->run([] { glEnable(0xFFFF); }), std::runtime_error);
  EXPECT_NO_THROW(gpu->run([] {}));
}

TEST(GpuThread, IsSharedAndEndsWithItsLastOwner) {
  auto first = GpuThread::shared();
  const std::weak_ptr<GpuThread> watch = first;
  auto second = GpuThread::shared();
  EXPECT_EQ(first, second);
  first.reset();
  EXPECT_FALSE(watch.expired());
  second.reset();
  EXPECT_TRUE(watch.expired());
}

TEST(GpuThread, NamesTheDriverAndItsLimits) {
  const GpuInfo info = GpuThread::shared()->info();
  EXPECT_FALSE(info.vendor.empty());
  EXPECT_FALSE(info.renderer.empty());
  EXPECT_FALSE(info.device.empty());
  EXPECT_GE(info.max_texture_size, 8192);
  EXPECT_GE(info.max_storage_buffer_bytes, int64_t{1} << 27);
}

TEST(GpuThread, TakesTheDeviceByTheNameThatItTells) {
  const std::string device = GpuThread::shared()->info().device;
  EXPECT_EQ(GpuThread(device).info().device, device);
}

TEST(GpuThread, RefusesAnUnknownDeviceByName) {
  try {
    GpuThread gpu("no such device");
    FAIL() << "must throw";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("no such device"), std::string::npos);
  }
}

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

TEST(ShaderSource, PutsVersionThenDefinesThenTheIncludedText) {
  const std::string source = shader_source("shared_types.h", {"SIZE 4"});
  EXPECT_TRUE(source.starts_with("#version 450 core\n"));
  EXPECT_NE(source.find("#define SIZE 4\n"), std::string::npos);
  EXPECT_EQ(source.find("#pragma once"), std::string::npos);
  EXPECT_THROW(shader_source("missing.comp.glsl"), std::runtime_error);
}

}  // namespace
}  // namespace snowbough::gpu
