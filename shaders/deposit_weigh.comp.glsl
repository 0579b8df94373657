// First of the deposit's three parts: every texel that takes part in the pixel above it adds its
// projected area to that pixel's sum, in integers, so that the order does not matter.
#include "texel_target.h"

layout(local_size_x = 64) in;
layout(std430) writeonly buffer TexelTargets { TexelTarget targets[]; };
layout(r32ui) uniform uimage2D weight_sum;

void main() {
  const int index = int(gl_GlobalInvocationID.x);
  const TexelTarget target = target_of(index);
  targets[index] = target;
  if (target.pixel != 0u) {
    const int pixel = int(target.pixel - 1u);
    imageAtomicAdd(weight_sum, ivec2(pixel % tile_size.x, pixel / tile_size.x), target.weight);
  }
}
