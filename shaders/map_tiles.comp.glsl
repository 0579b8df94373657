// The deepest snow of each tile of a height map, on either side: one work group a tile.
#include "lib/map_tiles.h"

layout(local_size_x = kSnowTile, local_size_y = kSnowTile) in;
uniform sampler2D height_map;
layout(std430) writeonly buffer TileDepths { float tile_depths[]; };

shared float depths[kSnowTile * kSnowTile];

void main() {
  const ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
  const ivec2 size = textureSize(height_map, 0);
  const int self = int(gl_LocalInvocationIndex);
  depths[self] = all(lessThan(texel, size)) ? abs(texelFetch(height_map, texel, 0).x) : 0.0;
  barrier();
  for (int half_count = kSnowTile * kSnowTile / 2; half_count > 0; half_count /= 2) {
    if (self < half_count) {
      depths[self] = max(depths[self], depths[self + half_count]);
    }
    barrier();
  }
  if (self == 0) {
    tile_depths[gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x] = depths[0];
  }
}
