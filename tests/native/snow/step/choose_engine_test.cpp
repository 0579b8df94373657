#include "snow/step/choose_engine.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace snowbough::snow {
namespace {

TEST(ChooseEngine, TakesTheOneThatIsAskedFor) {
  EngineChoice cpu({EngineKind::kCpu});
  EXPECT_EQ(cpu.engine().name(), "CPU");
  EXPECT_EQ(cpu.reason(), "requested");
  EngineChoice gl({EngineKind::kGl});
  EXPECT_EQ(gl.engine().name(), "GL");
  EXPECT_FALSE(gl.may_fall_back());
}

TEST(ChooseEngine, TakesOpenGlByItselfOnHardwareOnly) {
  EngineChoice choice({EngineKind::kAuto});
  const bool software = gpu::is_software(gpu::GpuThread::shared("")->info().renderer);
  EXPECT_EQ(choice.engine().name(), software ? "CPU" : "GL");
  EXPECT_NE(choice.reason(), "");
}

TEST(ChooseEngine, TakesOpenGlForGeometryAndForADeviceThatIsNamed) {
  EngineChoice geometry({EngineKind::kAuto, DepositMapping::kGeometry});
  EXPECT_EQ(geometry.engine().name(), "GL");
  EngineChoice named({EngineKind::kAuto, DepositMapping::kCompute, "surfaceless"});
  EXPECT_EQ(named.engine().name(), "GL");
}

TEST(ChooseEngine, RefusesGeometryOnTheProcessorAndDevicesThatAreNot) {
  EXPECT_THROW(EngineChoice({EngineKind::kCpu, DepositMapping::kGeometry}), std::invalid_argument);
  EngineChoice none({EngineKind::kGl, DepositMapping::kCompute, "no such device"});
  EXPECT_THROW(none.engine(), std::runtime_error);
}

TEST(ChooseEngine, FallsBackToTheProcessorAndSaysWhy) {
  EngineChoice choice({EngineKind::kGl});
  EXPECT_EQ(choice.fall_back("the driver refused a shader").name(), "CPU");
  EXPECT_EQ(choice.reason(), "the driver refused a shader");
}

TEST(ChooseEngine, KnowsThreeNames) {
  EXPECT_EQ(engine_kind("AUTO"), EngineKind::kAuto);
  EXPECT_EQ(engine_kind("GL"), EngineKind::kGl);
  EXPECT_EQ(engine_kind("CPU"), EngineKind::kCpu);
  EXPECT_THROW(engine_kind("VULKAN"), std::invalid_argument);
}

}  // namespace
}  // namespace snowbough::snow
