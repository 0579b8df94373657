// First of the deposit's three parts: every texel is evaluated on the current vertices and, where it takes
// part in the pixel above it, adds its projected area to that pixel's sum, in integers, so that the order
// does not matter.
#include "texel_group.h"
#include "texel_target.h"

layout(local_size_x = 64) in;
/// A TexelStep each, as one vector: llvmpipe stores it in one go.
layout(std430) writeonly buffer TexelSteps { uvec4 texel_steps[]; };
/// Per pixel of the tile.
layout(std430) buffer WeightSums { uint weight_sums[]; };

void main() {
  const int index = listed_texel();
  const TexelStep step = step_of(index);
  texel_steps[index] =
      uvec4(step.pixel, step.weight, floatBitsToUint(step.area), floatBitsToUint(step.up));
  if (step.weight != 0u) {
    atomicAdd(weight_sums[pixel_index(unpacked_pixel(step.pixel))], step.weight);
  }
}
