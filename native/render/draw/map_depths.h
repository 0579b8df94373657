#pragma once

#include "gpu/program.h"
#include "gpu/resources.h"

namespace snowbough::render {

/// Computes the greatest absolute height of a snow map (R32F, metres) on the GPU: per tile of
/// kSnowTile x kSnowTile texels, and of the whole map. GPU thread.
class MapDepths {
 public:
  /// Size of the buffer of tile depths in bytes: one float per tile, row by row.
  static int64_t tile_bytes(const gpu::Texture& map);
  /// `tiles`: a buffer of tile_bytes bytes.
  void find_tiles(const gpu::Texture& map, const gpu::Buffer& tiles);
  /// Writes to `deepest`, a buffer of one float, the largest value of `tiles`, which find_tiles has
  /// written.
  void find_deepest(const gpu::Buffer& tiles, const gpu::Buffer& deepest);

 private:
  gpu::Program tiles_{{"map_tiles.comp.glsl"}};
  gpu::Program deepest_{{"deepest_tile.comp.glsl"}};
};

}  // namespace snowbough::render
