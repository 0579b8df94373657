#pragma once

#include "gpu/program.h"
#include "gpu/resources.h"

namespace snowbough::render {

/// Computes the greatest absolute height of a snow map (R32F, metres) on the GPU, per tile of
/// kSnowTile x kSnowTile texels. GPU thread.
class MapDepths {
 public:
  /// Size of the buffer of tile depths in bytes: one float per tile, row by row.
  static int64_t tile_bytes(const gpu::Texture& map);
  /// `tiles`: a buffer of tile_bytes bytes.
  void find_tiles(const gpu::Texture& map, const gpu::Buffer& tiles);

 private:
  gpu::Program tiles_{{"map_tiles.comp.glsl"}};
};

}  // namespace snowbough::render
