#pragma once

#include "gpu/program.h"
#include "gpu/resources.h"

namespace snowbough::render {

/// How deep a map of snow (R32F, metres) is at most, on either side, found where the map lies: of
/// each tile of kSnowTile x kSnowTile texels, and of all. GPU thread.
class MapDepths {
 public:
  /// Bytes of the tiles' depths, a float each, row by row.
  static int64_t tile_bytes(const gpu::Texture& map);
  /// `tiles`: of tile_bytes.
  void find_tiles(const gpu::Texture& map, const gpu::Buffer& tiles);
  /// `deepest`: one float, the largest of `tiles`, which find_tiles has written.
  void find_deepest(const gpu::Buffer& tiles, const gpu::Buffer& deepest);

 private:
  gpu::Program tiles_{{"map_tiles.comp.glsl"}};
  gpu::Program deepest_{{"deepest_tile.comp.glsl"}};
};

}  // namespace snowbough::render
