// Opens (a step's sums at zero; with OPENING) or closes (totals brought up to date) every receiver's
// books.
#include "snow_shared.h"

layout(local_size_x = 64) in;
layout(std430) buffer Sums { ObjectSums sums[]; };
layout(std430) buffer Counts { PixelCounts counts[]; };
uniform uint object_count;
#ifndef OPENING
/// m2 of a pixel, and m3 of the snow that falls through one.
uniform float pixel_area;
uniform float pixel_volume;
#endif

void main() {
  const uint slot = gl_GlobalInvocationID.x;
  if (slot >= object_count) {
    return;
  }
  ObjectSums sum = sums[slot];
#ifdef OPENING
  sum.held_before = sum.held;
  sum.deposited = 0.0lf;
  sum.slid = 0.0lf;
  sum.held = 0.0lf;
  sum.saturated = 0.0lf;
  counts[slot] = PixelCounts(0u, 0u, 0u, 0u);
#else
  const PixelCounts count = counts[slot];
  sum.visible = double(count.visible);
  sum.back_facing = double(count.back_facing);
  sum.homeless = double(count.homeless);
  sum.fallen = double(count.snowed) * double(pixel_volume);
  sum.total_deposited += sum.deposited;
  sum.total_slid += sum.slid;
  sum.total_stretched += sum.held - (sum.held_before + sum.deposited - sum.slid);
  sum.total_saturated += sum.saturated;
  sum.total_visible_area += sum.visible * double(pixel_area);
  sum.total_homeless += sum.homeless;
  sum.total_fallen += sum.fallen;
#endif
  sums[slot] = sum;
}
