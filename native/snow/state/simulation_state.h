#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace snowbough::snow {

/// One receiver's part of a checkpoint.
struct ObjectState {
  std::string name;
  int32_t resolution = 0;
  /// Thickness in metres, resolution x resolution, row 0 = v 0.
  std::vector<float> height;
  /// The receiver's balance so far (shared::ObjectSums), in double precision.
  std::array<double, 16> sums{};
};

/// All that a simulation needs to go on as if it had never stopped, beside the objects themselves.
struct SimulationState {
  /// Number of steps done: noise and jitter go on from here.
  uint32_t step_number = 0;
  /// By name, ascending.
  std::vector<ObjectState> objects;
};

}  // namespace snowbough::snow
