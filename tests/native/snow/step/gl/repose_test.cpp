#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "gpu/resources.h"
#include "native/snow/bench.h"
#include "snow/step/cpu/engine.h"
#include "snow/step/frame_step.h"
#include "snow/step/gl/engine.h"

namespace snowbough::snow {
namespace {

constexpr int32_t kSide = 96;

std::unique_ptr<Engine> gl_engine() {
  return gl::make_engine(gpu::GpuThread::shared());
}

FrameStep repose_step(double degrees, double dt, double depth = 0.0) {
  FrameStep step;
  step.fall = falling({0.0, 0.0, -1.0}, 0.02, depth);
  step.stability = {100.0f, 1.0f};
  step.repose.angle = degrees / 180.0 * std::numbers::pi;
  step.dt = dt;
  return step;
}

/// A block of snow on a square of 96 texels of 1 cm: half a metre high, `from` to `to` in both
/// directions.
std::vector<float> block_of_snow(int32_t from, int32_t to) {
  std::vector<float> height(static_cast<size_t>(kSide * kSide), 0.0f);
  for (int32_t row = from; row < to; ++row) {
    for (int32_t column = from; column < to; ++column) {
      height[static_cast<size_t>(row * kSide + column)] = 0.5f;
    }
  }
  return height;
}

struct Rested {
  std::vector<float> height;
  shared::ObjectSums sums;
  int64_t reads = 0;
};

/// After three steps, in which `depth` metres of snow fall.
Rested rest(Engine& engine, const std::vector<float>& snow, double degrees, double depth = 0.0) {
  SceneObject ground = square("ground", 0.96f, 0.0f, kSide);
  Rested result;
  engine.run([&] {
    engine.build_scene({&ground});
    run_step(engine, {&ground}, repose_step(degrees, 0.0));
    engine.write_height(0, snow);
    const int64_t before = gpu::read_count();
    for (int step = 0; step < 3; ++step) {
      run_step(engine, {&ground}, repose_step(degrees, 0.25, depth / 3.0));
    }
    result.reads = gpu::read_count() - before;
    engine.read_height(0, result.height);
    result.sums = engine.read_sums(0);
  });
  return result;
}

double sum_of(const std::vector<float>& height) {
  double sum = 0.0;
  for (const float own : height) sum += static_cast<double>(own);
  return sum;
}

/// Steepest slope between texels side by side, as a tangent.
double steepest(const std::vector<float>& height) {
  double most = 0.0;
  for (int32_t row = 0; row < kSide; ++row) {
    for (int32_t column = 1; column < kSide; ++column) {
      const auto at = static_cast<size_t>(row * kSide + column);
      const auto turned = static_cast<size_t>(column * kSide + row);
      most = std::max<double>(most, std::abs(height[at] - height[at - 1]));
      most = std::max<double>(most, std::abs(height[turned] - height[turned - kSide]));
    }
  }
  return most / 0.01;
}

TEST(ReposeShaders, ReadNothingBack) {
  EXPECT_EQ(rest(*gl_engine(), block_of_snow(44, 50), 65.0, 0.01).reads, 0);
}

TEST(ReposeShaders, MoveSnowToTheAngleOfReposeAndKeepItsVolume) {
  const double limit = std::tan(40.0 / 180.0 * std::numbers::pi);
  const std::unique_ptr<Engine> engines[] = {gl_engine(), cpu::make_engine()};
  for (const std::unique_ptr<Engine>& engine : engines) {
    SCOPED_TRACE(engine_name(engine->kind()));
    const Rested heap = rest(*engine, block_of_snow(42, 52), 40.0);
    EXPECT_NEAR(sum_of(heap.height), 0.5 * 10 * 10, 1e-5 * 50.0);
    EXPECT_EQ(heap.sums.total_slid, 0.0);
    EXPECT_LE(steepest(heap.height), limit);
    EXPECT_GT(steepest(heap.height), 0.8 * limit);
  }
}

TEST(ReposeShaders, CountTheSnowThatFallsOverRims) {
  const double limit = std::tan(65.0 / 180.0 * std::numbers::pi);
  const std::unique_ptr<Engine> engines[] = {gl_engine(), cpu::make_engine()};
  for (const std::unique_ptr<Engine>& engine : engines) {
    SCOPED_TRACE(engine_name(engine->kind()));
    const Rested cap = rest(*engine, block_of_snow(0, kSide), 65.0);
    const double fell = 0.5 * 0.96 * 0.96 - sum_of(cap.height) * 1e-4;
    EXPECT_GT(fell, 0.1);
    EXPECT_NEAR(cap.sums.total_slid, fell, 1e-5 * fell);
    EXPECT_LE(steepest(cap.height), limit);
    // Half a texel from the rim.
    EXPECT_LE(*std::max_element(cap.height.begin(), cap.height.begin() + kSide), 0.005 * limit);
  }
}

TEST(ReposeShaders, GiveTheSameBitsTwice) {
  const std::vector<float> snow = block_of_snow(44, 51);
  EXPECT_EQ(rest(*gl_engine(), snow, 50.0).height, rest(*gl_engine(), snow, 50.0).height);
}

/// Blocks are 16 texels wide.
TEST(ReposeShaders, MoveSnowAlikeWhereverTheBlocksAre) {
  const std::vector<float> first = rest(*gl_engine(), block_of_snow(40, 47), 50.0).height;
  const std::vector<float> second = rest(*gl_engine(), block_of_snow(45, 52), 50.0).height;
  double most = 0.0;
  for (int32_t row = 0; row < kSide - 5; ++row) {
    for (int32_t column = 0; column < kSide - 5; ++column) {
      const float one = first[static_cast<size_t>(row * kSide + column)];
      const float other = second[static_cast<size_t>((row + 5) * kSide + column + 5)];
      most = std::max<double>(most, std::abs(one - other));
    }
  }
  // Positions of texels differ in their last bits.
  EXPECT_LT(most, 1e-4);
}

}  // namespace
}  // namespace snowbough::snow
