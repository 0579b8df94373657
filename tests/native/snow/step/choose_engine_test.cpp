#include "snow/step/choose_engine.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace snowbough::snow {
namespace {

TEST(ChooseEngine, UsesTheRequestedEngine) {
  EngineChoice cpu({EngineKind::kCpu});
  EXPECT_EQ(cpu.engine().kind(), EngineKind::kCpu);
  EXPECT_EQ(cpu.reason(), "requested");
  EngineChoice gl({EngineKind::kGl});
  EXPECT_EQ(gl.engine().kind(), EngineKind::kGl);
  EXPECT_FALSE(gl.may_fall_back());
}

TEST(ChooseEngine, AutoUsesOpenGlOnHardwareOnly) {
  EngineChoice choice({EngineKind::kAuto});
  const bool software = gpu::is_software(gpu::GpuThread::shared("")->info().renderer);
  EXPECT_EQ(choice.engine().kind(), software ? EngineKind::kCpu : EngineKind::kGl);
  EXPECT_NE(choice.reason(), "");
}

TEST(ChooseEngine, AutoUsesOpenGlForGeometryAndForANamedDevice) {
  EngineChoice geometry({EngineKind::kAuto, DepositMapping::kGeometry});
  EXPECT_EQ(geometry.engine().kind(), EngineKind::kGl);
  EngineChoice named({EngineKind::kAuto, DepositMapping::kCompute, "surfaceless"});
  EXPECT_EQ(named.engine().kind(), EngineKind::kGl);
}

TEST(ChooseEngine, RefusesGeometryOnTheProcessorAndUnknownDevices) {
  EXPECT_THROW(EngineChoice({EngineKind::kCpu, DepositMapping::kGeometry}), std::invalid_argument);
  EngineChoice none({EngineKind::kGl, DepositMapping::kCompute, "no such device"});
  EXPECT_THROW(none.engine(), std::runtime_error);
}

TEST(ChooseEngine, FallsBackToTheProcessorAndSaysWhy) {
  EngineChoice choice({EngineKind::kGl});
  EXPECT_EQ(choice.fall_back("the driver refused a shader").kind(), EngineKind::kCpu);
  EXPECT_EQ(choice.reason(), "the driver refused a shader");
}

TEST(ChooseEngine, KnowsThreeNames) {
  EXPECT_EQ(engine_kind("AUTO"), EngineKind::kAuto);
  EXPECT_EQ(engine_kind("GL"), EngineKind::kGl);
  EXPECT_EQ(engine_kind("CPU"), EngineKind::kCpu);
  EXPECT_THROW(engine_kind("VULKAN"), std::invalid_argument);
  EXPECT_EQ(engine_name(EngineKind::kAuto), "AUTO");
  EXPECT_EQ(engine_name(EngineKind::kGl), "GL");
  EXPECT_EQ(engine_name(EngineKind::kCpu), "CPU");
}

}  // namespace
}  // namespace snowbough::snow
