// Opens every receiver's balance (with OPENING: sets the step's sums to zero) or closes it (updates the totals).
#include "lib/object_sums.h"

layout(local_size_x = 64) in;
layout(std430) buffer Sums { ObjectSums sums[]; };
/// Pixels of back faces, by slot.
layout(std430) buffer BackPixels { uint back_pixels[]; };
uniform uint object_count;
#ifndef OPENING
/// In m2.
uniform float pixel_area;
#endif

void main() {
  const uint slot = gl_GlobalInvocationID.x;
  if (slot >= object_count) {
    return;
  }
#ifdef OPENING
  sums[slot] = opened(sums[slot]);
  back_pixels[slot] = 0u;
#else
  sums[slot] = closed(sums[slot], back_pixels[slot], pixel_area);
#endif
}
