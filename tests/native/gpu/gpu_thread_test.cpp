#include "gpu/gpu_thread.h"

#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include <atomic>
#include <exception>
#include <future>
#include <stdexcept>
#include <string>

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
  EXPECT_GE(info.max_array_layers, 2048);  // what OpenGL 4.5 guarantees
  EXPECT_GE(info.max_storage_buffer_bytes, int64_t{1} << 27);
}

TEST(GpuThread, OpensADeviceByItsName) {
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

TEST(GpuThread, PostReturnsAtOnceAndHandsErrorsOver) {
  const auto thread = GpuThread::shared();
  std::promise<void> open;
  std::promise<std::string> message;
  std::atomic<int> done{0};
  const auto note = [&](const std::exception_ptr& error) {
    try {
      std::rethrow_exception(error);
    } catch (const std::exception& what) {
      message.set_value(what.what());
    }
  };
  thread->post([&] { open.get_future().wait(); }, note);  // would wait for ever, if post did
  thread->post([&] { done = 1; }, note);
  EXPECT_EQ(done, 0);
  open.set_value();
  thread->post([] { throw std::runtime_error("broken"); }, note);
  EXPECT_EQ(message.get_future().get(), "broken");
  EXPECT_EQ(done, 1);
}

TEST(GpuThread, AGlErrorOfPostedWorkIsReportedOnce) {
  const auto thread = GpuThread::shared();
  std::promise<std::string> message;
  thread->post([] { glEnable(0xFFFF); },
               [&](const std::exception_ptr& error) {
                 try {
                   std::rethrow_exception(error);
                 } catch (const std::exception& what) {
                   message.set_value(what.what());
                 }
               });
  EXPECT_NE(message.get_future().get().find("0x0500"), std::string::npos);
  thread->run([] {});  // throws what is left behind
}

}  // namespace
}  // namespace snowbough::gpu
