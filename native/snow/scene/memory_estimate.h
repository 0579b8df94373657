#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "snow/scene/scene_object.h"

namespace snowbough::snow {

/// Bytes that a simulation will take, on the GPU or in main memory, depending on its engine; known
/// before anything is allocated.
struct MemoryEstimate {
  /// Height maps, and the further maps of an engine.
  int64_t maps = 0;
  /// Data of the passes per owned texel.
  int64_t texels = 0;
  /// Vertices, triangles and alpha masks; shared masks count once.
  int64_t geometry = 0;
  /// The occlusion tile.
  int64_t tile = 0;
  /// Working memory of the output, for two maps at a time, in main memory.
  int64_t output = 0;
  /// Tables for levelling the receivers' seams: always in main memory, but small enough to count
  /// here.
  int64_t seams = 0;

  /// Repose, if snow moves, in main memory.
  int64_t repose = 0;

  int64_t total() const { return maps + texels + geometry + tile + output + seams + repose; }
  /// One line for people: "812 MiB (maps 512, ...)".
  std::string text() const;
};

/// The part that is the same for all engines: height maps, geometry, output and seams.
MemoryEstimate estimate_shared_memory(const std::vector<const SceneObject*>& objects);

/// Number of blocks of `side` x `side` texels with at least one texel, in the objects' maps.
int64_t count_blocks(const std::vector<const SceneObject*>& objects, int32_t side);

/// Number of texels at the rim of their chart.
int64_t count_rim_texels(const TexelTable& table);

/// Free memory of the machine in bytes; 0 = unknown.
int64_t machine_memory();

/// @throws std::runtime_error with the figures and advice if the estimate exceeds `available`.
void require_memory(const MemoryEstimate& estimate, int64_t available);

}  // namespace snowbough::snow
