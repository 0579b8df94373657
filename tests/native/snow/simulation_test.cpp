#include "snow/simulation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <numbers>

namespace snowbough::snow {
namespace {

using ::testing::HasSubstr;

class SavedSimulation : public ::testing::Test {
 protected:
  SavedSimulation()
      : path_(std::filesystem::temp_directory_path() /
              ("snowbough_simulation_" + std::to_string(::getpid()) + "_" +
               ::testing::UnitTest::GetInstance()->current_test_info()->name())) {}
  ~SavedSimulation() override { std::filesystem::remove(path_); }

  static SimulationSettings fluttering(double angle) {
    SimulationSettings settings;
    settings.engine = EngineKind::kCpu;
    settings.flutter = angle;
    return settings;
  }

  /// Why the file at path_ is not continued with this flutter.
  std::string refusal(double angle) const {
    try {
      SnowSimulation(fluttering(angle)).restore(path_, false);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  }

  /// What saved when flutter was in degrees.
  void save_with_degrees(const std::string& degrees) const {
    SnowSimulation(fluttering(0.0)).save(path_);
    Checkpoint old = load_checkpoint(path_);
    const std::string none = "flutter=0x0p+0\n";
    const size_t at = old.description.find(none);
    ASSERT_NE(at, std::string::npos) << old.description;
    old.description.replace(at, none.size(), "flutter=" + degrees + "\n");
    save_checkpoint(path_, old);
  }

  std::string path_;
};

TEST_F(SavedSimulation, continuesWithItsFlutterAlone) {
  SnowSimulation(fluttering(0.05)).save(path_);
  EXPECT_EQ(refusal(0.05), "accepted");
  EXPECT_THAT(refusal(0.06), HasSubstr("differences: flutter"));
}

TEST_F(SavedSimulation, ofHalfADegreeIsNotTakenForHalfARadian) {
  save_with_degrees("0x1p-1");
  EXPECT_THAT(refusal(0.5), HasSubstr("differences: flutter, flutter in radians"));
}

TEST_F(SavedSimulation, withoutFlutterContinuesWhateverItsUnitWas) {
  save_with_degrees("0x0p+0");
  EXPECT_EQ(refusal(0.0), "accepted");
}

TEST(Simulation, takesFlutterInRadians) {
  const auto make = [](double angle) {
    SimulationSettings settings;
    settings.engine = EngineKind::kCpu;
    settings.flutter = angle;
    const SnowSimulation simulation(settings);
  };
  EXPECT_NO_THROW(make(static_cast<double>(static_cast<float>(std::numbers::pi / 4.0))));
  EXPECT_THROW(make(1.0), std::invalid_argument);
  EXPECT_THROW(make(-0.1), std::invalid_argument);
}

}  // namespace
}  // namespace snowbough::snow
