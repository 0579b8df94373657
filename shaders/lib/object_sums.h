#pragma once

// Opens and closes a receiver's balance for a step. For C++ and GLSL.
#include "snow_shared.h"
#include "shared_functions.h"

#ifndef SNOWBOUGH_GLSL
namespace snowbough::shared {
#endif

/// The balance with the step's sums at zero.
SNOWBOUGH_SHARED_FUNCTION ObjectSums opened(KERNEL_CONST_REF(ObjectSums) before) {
  ObjectSums sum = before;
  sum.held_before = before.held;
  sum.deposited = double(0);
  sum.slid = double(0);
  sum.held = double(0);
  sum.landed = double(0);
  sum.removed = double(0);
  sum.visible_area = double(0);
  return sum;
}

/// The balance with its totals updated. `back_pixels`: pixels of back faces, of `pixel_area` m2 each.
SNOWBOUGH_SHARED_FUNCTION ObjectSums closed(KERNEL_CONST_REF(ObjectSums) before, uint back_pixels,
                                            float pixel_area) {
  ObjectSums sum = before;
  sum.back_face_area = double(back_pixels) * double(pixel_area);
  sum.total_deposited += sum.deposited;
  sum.total_slid += sum.slid;
  sum.total_landed += sum.landed;
  sum.total_stretched += sum.held - (sum.held_before + sum.deposited + sum.landed - sum.slid - sum.removed);
  sum.total_visible_area += sum.visible_area;
  return sum;
}

#ifndef SNOWBOUGH_GLSL
}  // namespace snowbough::shared
#endif
