#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "snow/scene/scene_object.h"

namespace snowbough::snow {

/// What a simulation will take in bytes, on the GPU or in main memory as its engine works, told
/// before anything is allocated.
struct MemoryEstimate {
  /// Height maps, and owner tables where there are any.
  int64_t maps = 0;
  /// What the passes keep per owned texel.
  int64_t texels = 0;
  /// Vertices, triangles and alpha masks, the ones that objects share counted once.
  int64_t geometry = 0;
  /// The occlusion tile.
  int64_t tile = 0;
  /// What making output works on, for two maps at a time, in main memory.
  int64_t output = 0;
  /// What levelling keeps of the receivers' seams: in main memory always, but counted here, since
  /// it is little.
  int64_t seams = 0;

  /// What repose keeps, where snow moves, in main memory; the caller adds it.
  int64_t repose = 0;

  int64_t total() const { return maps + texels + geometry + tile + output + seams + repose; }
  /// One line for people: "812 MiB (maps 512, ...)".
  std::string text() const;
};

/// `with_owners`: see SceneBuffers.
MemoryEstimate estimate_memory(const std::vector<const SceneObject*>& objects, int32_t tile_size,
                               bool with_owners = false);

/// Free memory of the machine in bytes; 0 = unknown.
int64_t machine_memory();

/// @throws std::runtime_error with the figures and a hint when the estimate is more than is
/// available.
void require_memory(const MemoryEstimate& estimate, int64_t available);

}  // namespace snowbough::snow
