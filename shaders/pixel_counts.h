// GLSL only: counters of what the sky sees of every object.
#include "fall_frame.h"

layout(std430) buffer Counts { PixelCounts counts[]; };

void flush(uint slot, inout PixelCounts count) {
  if (count.visible > 0u) {
    atomicAdd(counts[slot].visible, count.visible);
  }
  if (count.back_facing > 0u) {
    atomicAdd(counts[slot].back_facing, count.back_facing);
  }
  if (count.homeless > 0u) {
    atomicAdd(counts[slot].homeless, count.homeless);
  }
  if (count.snowed > 0u) {
    atomicAdd(counts[slot].snowed, count.snowed);
  }
  count = PixelCounts(0u, 0u, 0u, 0u);
}
