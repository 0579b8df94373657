#include "gpu/gpu_thread.h"

#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include <atomic>
#include <exception>
#include <future>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

#include "gpu/program.h"
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
  GpuThread gpu("no such device");
  EXPECT_THROW(gpu.run([] {}), std::runtime_error);
  EXPECT_THROW(GpuThread::shared("no such device"), std::runtime_error);
  try {
    gpu.info();
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

TEST(Program, DispatchItemsReachesEveryItemInRowsOfGroups) {
  GpuThread::shared()->run([] {
    // Row r takes value r to place r; 1000 rows in groups of 64, at most 3 groups side by side.
    constexpr int32_t kCount = 1000;
    std::vector<int32_t> begin(kCount + 1), place(kCount);
    std::iota(begin.begin(), begin.end(), 0);
    std::iota(place.begin(), place.end(), 0);
    std::vector<float> values(kCount);
    std::iota(values.begin(), values.end(), 1.0f);
    Program rows({"weighted_rows.comp.glsl"});
    const Buffer begins(begin), places(place), weights(std::vector<float>(kCount, 1.0f));
    const Buffer source(values);
    Buffer target(int64_t{4} * kCount);
    rows.use();
    rows.bind("RowBegin", begins);
    rows.bind("RowSource", places);
    rows.bind("RowWeight", weights);
    rows.bind("RowTarget", places);
    rows.bind("SourceValues", source);
    rows.bind("TargetValues", target);
    rows.set("count", kCount);
    rows.set("nothing_without_terms", 0);
    rows.dispatch_items(kCount, 64, 3);
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    EXPECT_EQ(target.read_all<float>(), values);
  });
}

TEST(GpuThread, PostReturnsAtOnceAndHandsErrorsOver) {
  const auto thread = GpuThread::shared();
  std::promise<void> open;
  std::promise<std::string> told;
  std::atomic<int> done{0};
  const auto note = [&](const std::exception_ptr& error) {
    try {
      std::rethrow_exception(error);
    } catch (const std::exception& what) {
      told.set_value(what.what());
    }
  };
  thread->post([&] { open.get_future().wait(); }, note);  // would wait for ever, if post did
  thread->post([&] { done = 1; }, note);
  EXPECT_EQ(done, 0);
  open.set_value();
  thread->post([] { throw std::runtime_error("broken"); }, note);
  EXPECT_EQ(told.get_future().get(), "broken");
  EXPECT_EQ(done, 1);
}

TEST(GpuThread, AnErrorOfPostedGlIsHandedOverAndGone) {
  const auto thread = GpuThread::shared();
  std::promise<std::string> told;
  thread->post([] { glEnable(0xFFFF); },
               [&](const std::exception_ptr& error) {
                 try {
                   std::rethrow_exception(error);
                 } catch (const std::exception& what) {
                   told.set_value(what.what());
                 }
               });
  EXPECT_NE(told.get_future().get().find("0x0500"), std::string::npos);
  thread->run([] {});  // throws what is left behind
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
