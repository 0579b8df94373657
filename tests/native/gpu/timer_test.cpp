#include "gpu/timer.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

#include "gpu/gpu_thread.h"
#include "gpu/program.h"
#include "native/gpu/weighted_rows.h"

namespace snowbough::gpu {
namespace {

/// Adds up `count` rows of one term each, `rounds` times.
void sum_rows(int32_t count, int rounds) {
  static_assert(sizeof(float) == sizeof(int32_t));
  const std::vector<int32_t> zeros(static_cast<size_t>(count) + 1, 0);
  const Buffer begins(zeros), source(zeros);
  Buffer target(int64_t{4} * count);
  Program rows({"weighted_rows.comp.glsl"});
  use_for(rows, {begins, begins, begins, begins, source, target}, count);
  for (int i = 0; i < rounds; ++i) {
    rows.dispatch_items(count, 64);
  }
}

TEST(PassTimer, ReportsPassesInTheirOrderAndForgetsThem) {
  GpuThread::shared()->run([] {
    PassTimer timer;
    { const auto pass = timer.measure("first"); }
    { const auto pass = timer.measure("second"); }
    const std::vector<PassTime> times = timer.take();
    ASSERT_EQ(times.size(), 2u);
    EXPECT_EQ(times[0].name, "first");
    EXPECT_EQ(times[1].name, "second");
    EXPECT_TRUE(timer.take().empty());
  });
}

TEST(PassTimer, MoreWorkTakesMoreOfTheGpusTime) {
  GpuThread::shared()->run([] {
    PassTimer timer;
    sum_rows(64, 1);  // compiles
    { const auto pass = timer.measure("nothing"); }
    {
      const auto pass = timer.measure("work");
      sum_rows(1 << 18, 50);
    }
    const std::vector<PassTime> times = timer.take();
    EXPECT_GT(times[1].gpu_seconds, 0.0);
    EXPECT_GT(times[1].gpu_seconds, times[0].gpu_seconds);
    EXPECT_GT(times[1].wall_seconds, times[0].wall_seconds);
    EXPECT_EQ(times[1].primitives, 0u) << "a compute pass draws nothing";
  });
}

TEST(PassTimer, RefusesAPassWithinAPass) {
  GpuThread::shared()->run([] {
    PassTimer timer;
    {
      const auto pass = timer.measure("outer");
      EXPECT_THROW(static_cast<void>(timer.measure("inner")), std::logic_error);
      EXPECT_THROW(timer.take(), std::logic_error);
    }
    EXPECT_EQ(timer.take().size(), 1u);
  });
}

TEST(PassTimer, MeasuresNothingWhereItIsOff) {
  GpuThread::shared()->run([] {
    PassTimer timer;
    timer.set_enabled(false);
    { const auto pass = timer.measure("off"); }
    timer.set_enabled(true);
    { const auto pass = timer.measure("on"); }
    const std::vector<PassTime> times = timer.take();
    ASSERT_EQ(times.size(), 1u);
    EXPECT_EQ(times[0].name, "on");
  });
}

}  // namespace
}  // namespace snowbough::gpu
