// Fourth part of the deposit: snow for a texel much smaller than its pixel is laid evenly on it and its
// neighbours. Kept apart from the part before because software renderers run every branch for every pixel.
#include "deposit_units.h"
#include "texel_spread.h"

layout(local_size_x = 64) in;
layout(std430) readonly buffer SpreadListSize { ListSize spread_size; };
layout(std430) readonly buffer SpreadList { SpreadSnow spread_list[]; };

void lay(float volume, int texel) {
  const ivec3 place = place_of(texel);
  const uint chart = texelFetch(owners, place, 0).y >> 8u;
  float area;
  const int reach = spread_reach(texel, place, chart, area);
  add_to_texel(texel, volume / area);
  const int width = 2 * reach + 1;
  for (int i = 0; i < width * width && reach > 0; ++i) {
    const ivec2 offset = ivec2(i % width, i / width) - reach;
    const int other = offset == ivec2(0) ? -1 : sharing_texel(place + ivec3(offset, 0), chart);
    if (other >= 0) {
      add_to_texel(other, volume / area);
    }
  }
}

void main() {
  const uint stride = gl_NumWorkGroups.x * gl_WorkGroupSize.x;
  for (uint i = gl_GlobalInvocationID.x; i < spread_size.count; i += stride) {
    const SpreadSnow snow = spread_list[i];
    lay(snow.volume, int(snow.texel));
  }
}
