#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace snowbough::snow {

/// One receiver's part of a state.
struct ObjectState {
  std::string name;
  int32_t resolution = 0;
  /// Thickness in metres, resolution x resolution, row 0 = v 0.
  std::vector<float> height;
  /// The receiver's balance so far (shared::ObjectSums), in double precision.
  std::array<double, 18> sums{};
  /// What passes keep for each texel between steps, by name; as `height`.
  std::map<std::string, std::vector<float>> planes;
};

/// Snow in the air.
struct FallingSnow {
  /// When it lands, by LandingState::clock.
  int64_t time = 0;
  /// The receiver's name.
  std::string receiver;
  /// row * resolution + column.
  int32_t place = 0;
  bool is_back = false;
  /// Of 2^-44 m3.
  int64_t units = 0;
};

/// What landing keeps between steps. Volumes in units of 2^-44 m3.
struct LandingState {
  /// Sum of the steps' durations in microseconds.
  int64_t clock = 0;
  /// Sorted.
  std::vector<FallingSnow> air;
  /// Volume that has fallen onto objects without a map, and out of the scene.
  int64_t on_floors = 0;
  int64_t left = 0;
};

/// Everything that a simulation needs to continue exactly, except the objects themselves.
struct SimulationState {
  /// Number of steps done: noise and jitter depend on it.
  uint32_t step_number = 0;
  /// By name, ascending.
  std::vector<ObjectState> objects;
  LandingState landing;
  /// Positions of the last step, in metres, of objects that press snow.
  std::map<std::string, std::vector<glm::vec3>> pressers;
};

/// A state as a file: of all receivers (SnowSimulation::save), or of the receivers that a bake can
/// resume individually.
struct Checkpoint {
  /// Identifies the simulation: settings, topology and driver. The caller writes it, and refuses a
  /// file with another one; may be empty.
  std::string description;
  SimulationState state;
};

/// Writes a checkpoint atomically (docs/formats.md has the layout): little-endian, versioned, bare
/// texels as a packed mask, a CRC-32 over everything. The same checkpoint gives the same bytes.
/// @throws std::invalid_argument when a map's size is not its resolution squared,
/// std::runtime_error with path and reason when the disk refuses.
void save_checkpoint(const std::string& path, const Checkpoint& checkpoint);

/// The header of a checkpoint, read before memory is allocated for its maps.
struct CheckpointOutline {
  std::string description;
  /// Name and resolution of each map.
  std::vector<std::pair<std::string, int32_t>> maps;
};

/// Reads a checkpoint back, bit for bit.
/// @param check  receives the outline first and throws std::invalid_argument for a file of another
///   simulation: a few bytes can stand for a large bare map.
/// @throws std::runtime_error with the path and the reason: missing, not a Snowbough checkpoint,
/// another version, truncated, or damaged; and as `check`.
Checkpoint load_checkpoint(const std::string& path,
                           const std::function<void(const CheckpointOutline&)>& check = {});

}  // namespace snowbough::snow
