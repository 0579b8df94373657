#include "snow/simulation.h"

#include <gtest/gtest.h>

#include <numbers>

namespace snowbough::snow {
namespace {

TEST(Simulation, takesFlutterInRadians) {
  const auto make = [](double angle) {
    SimulationSettings settings;
    settings.engine.kind = EngineKind::kCpu;
    settings.flutter = angle;
    const SnowSimulation simulation(settings);
  };
  EXPECT_NO_THROW(make(static_cast<double>(static_cast<float>(std::numbers::pi / 2.0))));
  EXPECT_THROW(make(3.0), std::invalid_argument);
  EXPECT_THROW(make(-0.1), std::invalid_argument);
}

}  // namespace
}  // namespace snowbough::snow
