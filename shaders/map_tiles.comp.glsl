// The deepest snow of the tiles of pages, on either side: one work group a tile.
#include "lib/map_tiles.h"

layout(local_size_x = kSnowTile, local_size_y = kSnowTile) in;
uniform sampler2DArray snow_pages;
/// The pages whose tiles are computed.
layout(std430) readonly buffer NewPages { int new_pages[]; };
layout(std430) writeonly buffer TileDepths { float tile_depths[]; };

shared float depths[kSnowTile * kSnowTile];

void main() {
  const int page = new_pages[gl_WorkGroupID.z];
  const int self = int(gl_LocalInvocationIndex);
  depths[self] = abs(texelFetch(snow_pages, ivec3(gl_GlobalInvocationID.xy, page), 0).x);
  barrier();
  for (int half_count = kSnowTile * kSnowTile / 2; half_count > 0; half_count /= 2) {
    if (self < half_count) {
      depths[self] = max(depths[self], depths[self + half_count]);
    }
    barrier();
  }
  if (self == 0) {
    tile_depths[(page * kPageTiles + int(gl_WorkGroupID.y)) * kPageTiles + int(gl_WorkGroupID.x)] = depths[0];
  }
}
