// Finds the deepest of a map's tiles, in one work group.
#include "lib/snow_patch.h"

layout(local_size_x = kDeepestGroup) in;
layout(std430) readonly buffer TileDepths { float tile_depths[]; };
layout(std430) writeonly buffer DeepestSnow { float deepest_snow[]; };
uniform int count;

shared float depths[kDeepestGroup];

void main() {
  const int self = int(gl_LocalInvocationIndex);
  float deepest = 0.0;
  for (int i = self; i < count; i += kDeepestGroup) {
    deepest = max(deepest, tile_depths[i]);
  }
  depths[self] = deepest;
  barrier();
  for (int half_count = kDeepestGroup / 2; half_count > 0; half_count /= 2) {
    if (self < half_count) {
      depths[self] = max(depths[self], depths[self + half_count]);
    }
    barrier();
  }
  if (self == 0) {
    deepest_snow[0] = depths[0];
  }
}
