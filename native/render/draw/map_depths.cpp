#include "render/draw/map_depths.h"

#include "shaders/lib/map_tiles.h"

namespace snowbough::render {

int64_t MapDepths::tile_bytes(const gpu::Texture& map) {
  return static_cast<int64_t>(sizeof(float)) * gpu::group_count(map.width(), shared::kSnowTile) *
         gpu::group_count(map.height(), shared::kSnowTile);
}

void MapDepths::find_tiles(const gpu::Texture& map, const gpu::Buffer& tiles) {
  tiles_.use();
  tiles_.bind_texture("height_map", map);
  tiles_.bind("TileDepths", tiles);
  tiles_.dispatch(gpu::group_count(map.width(), shared::kSnowTile),
                  gpu::group_count(map.height(), shared::kSnowTile));
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

}  // namespace snowbough::render
