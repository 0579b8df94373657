#pragma once

// First of the deposit's parts, for one texel: it is evaluated on the current vertices and, where it takes
// part in the pixel above it, adds its projected area to that pixel's sum, in integers, so that the order
// does not matter.
#include "kernel.h"
#include "texel_target.h"

/// A TexelStep each, as one vector: llvmpipe stores it in one go.
KERNEL_BLOCK_WRITEONLY(TexelSteps, uvec4, texel_steps);
/// Per pixel of the tile.
KERNEL_BLOCK(WeightSums, uint, weight_sums);

/// `object`: see texel_object.
void weigh_texel(int index, uint object) {
  const TexelStep step = step_of(index, object);
  texel_steps[index] =
      uvec4(step.pixel, step.weight, floatBitsToUint(step.area), floatBitsToUint(step.up));
  if (step.weight != 0u) {
    atomicAdd(weight_sums[pixel_index(unpacked_pixel(step.pixel))], step.weight);
  }
}
