// Opens (a step's sums at zero; with OPENING) or closes (totals brought up to date) every receiver's
// books.
#include "snow_shared.h"

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
  ObjectSums sum = sums[slot];
#ifdef OPENING
  sum.held_before = sum.held;
  sum.deposited = 0.0lf;
  sum.slid = 0.0lf;
  sum.held = 0.0lf;
  sum.visible_area = 0.0lf;
  back_pixels[slot] = 0u;
#else
  sum.back_face_area = double(back_pixels[slot]) * double(pixel_area);
  sum.total_deposited += sum.deposited;
  sum.total_slid += sum.slid;
  sum.total_stretched += sum.held - (sum.held_before + sum.deposited - sum.slid);
  sum.total_visible_area += sum.visible_area;
#endif
  sums[slot] = sum;
}
