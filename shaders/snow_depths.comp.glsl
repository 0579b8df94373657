// The deepest snow that may lie on each patch: that of the tiles of the map under it.
#include "lib/snow_patch.h"

layout(local_size_x = 64) in;
#include "glsl/item_index.glsl"
layout(std430) readonly buffer SnowPatches { SnowPatch patches[]; };
layout(std430) readonly buffer TileDepths { float tile_depths[]; };
layout(std430) writeonly buffer PatchDepths { float patch_depths[]; };
uniform int count;
/// Of the map, in texels.
uniform ivec2 map_size;

void main() {
  const int index = item_index();
  if (index >= count) {
    return;
  }
  const SnowPatch of = patches[index];
  const vec2 low = min(min(of.uv_01.xy, of.uv_01.zw), of.uv_2.xy) * vec2(map_size) - float(kSnowReach);
  const vec2 high = max(max(of.uv_01.xy, of.uv_01.zw), of.uv_2.xy) * vec2(map_size) + float(kSnowReach);
  const ivec2 tiles = (map_size + kSnowTile - 1) / kSnowTile;
  const ivec2 first = clamp(ivec2(floor(low)) / kSnowTile, ivec2(0), tiles - 1);
  const ivec2 last = clamp(ivec2(floor(high)) / kSnowTile, ivec2(0), tiles - 1);
  float deepest = 0.0;
  for (int y = first.y; y <= last.y; ++y) {
    for (int x = first.x; x <= last.x; ++x) {
      deepest = max(deepest, tile_depths[y * tiles.x + x]);
    }
  }
  patch_depths[index] = deepest;
}
