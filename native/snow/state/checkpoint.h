#pragma once

#include <array>
#include <cstdint>
#include <functional>
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
  std::array<double, 16> sums{};
};

/// All that a simulation needs to go on as if it had never stopped, beside the objects themselves.
struct SimulationState {
  /// Number of steps done: noise and jitter go on from here.
  uint32_t step_number = 0;
  /// By name, ascending.
  std::vector<ObjectState> objects;
};

/// A state as a file: of all receivers (SnowSimulation::save), or of those that a bake can go on
/// with by themselves.
struct Checkpoint {
  /// Whose state this is: settings, topology and driver. What it is made of is the caller's
  /// business, who refuses another one with what changed; may be empty.
  std::string description;
  SimulationState state;
};

/// Writes a checkpoint atomically (docs/formats.md has the layout): little-endian, versioned, bare
/// texels as a packed mask, a CRC-32 over everything. The same checkpoint gives the same bytes.
/// @throws std::invalid_argument when a map's size is not its resolution squared,
/// std::runtime_error with path and reason when the disk refuses.
void save_checkpoint(const std::string& path, const Checkpoint& checkpoint);

/// What a checkpoint says of itself, known before memory is taken for its maps.
struct CheckpointOutline {
  std::string description;
  /// Name and resolution of each map.
  std::vector<std::pair<std::string, int32_t>> maps;
};

/// Reads a checkpoint back, bit for bit.
/// @param check  sees the outline first and throws std::invalid_argument for a file that belongs to
/// something else: a few bytes can stand for a large bare map.
/// @throws std::runtime_error with the path and what is wrong: not there, not a Snowbough
/// checkpoint, written by another version, truncated, or damaged; what `check` throws.
Checkpoint load_checkpoint(const std::string& path,
                           const std::function<void(const CheckpointOutline&)>& check = {});

}  // namespace snowbough::snow
