#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace snowbough::snow {

/// One receiver's state.
struct CheckpointMap {
  std::string name;
  int32_t resolution = 0;
  /// Stored thickness in metres, resolution^2, row 0 = v 0.
  std::vector<float> height;
  /// The receiver's double-precision totals, by name, in the order that the simulation gives them.
  std::vector<std::pair<std::string, double>> totals;
};

/// All that a simulation needs to go on as if it had never stopped.
struct CheckpointData {
  /// Whose state this is: a digest of settings, topology and driver. What it is made of is the
  /// simulation's business; another digest is refused by the caller with what changed.
  std::string description;
  /// Number of steps done, which the noise and the jitter are counted by.
  uint64_t step_number = 0;
  /// The simulation's double-precision totals, by name.
  std::vector<std::pair<std::string, double>> totals;
  std::vector<CheckpointMap> maps;
};

/// Writes a checkpoint atomically (docs/formats.md has the layout): little-endian, versioned, maps
/// packed by zlib without loss, a CRC-32 over everything. The same data gives the same bytes.
/// @throws std::invalid_argument when a map's size is not its resolution squared,
/// std::runtime_error with path and reason when the disk refuses.
void save_checkpoint(const std::string& path, const CheckpointData& data);

/// Reads a checkpoint back, bit for bit.
/// @throws std::runtime_error with the path and what is wrong: not there, not a Snowbough
/// checkpoint, written by another version, truncated, or damaged.
CheckpointData load_checkpoint(const std::string& path);

}  // namespace snowbough::snow
