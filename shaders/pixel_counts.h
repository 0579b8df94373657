// GLSL only: counters of what the sky sees of every object.
#include "snow_shared.h"

layout(std430) buffer Counts { PixelCounts counts[]; };

void flush(uint slot, inout PixelCounts count) {
  if (count.visible > 0u) {
    atomicAdd(counts[slot].visible, count.visible);
  }
  if (count.back_facing > 0u) {
    atomicAdd(counts[slot].back_facing, count.back_facing);
  }
  count = PixelCounts(0u, 0u);
}
