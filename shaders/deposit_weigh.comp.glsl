// First of the deposit's three parts: every texel that takes part in the pixel above it adds its
// projected area to that pixel's sum, in integers, so that the order does not matter.
#include "texel_group.h"
#include "texel_target.h"

layout(local_size_x = 64) in;
layout(std430) writeonly buffer TexelTargets { TexelTarget targets[]; };
layout(r32ui) uniform uimage2D weight_sum;

void main() {
  const int index = listed_texel();
  const TexelTarget target = target_of(index);
  targets[index] = target;
  if (target.weight != 0u) {
    imageAtomicAdd(weight_sum, unpacked_pixel(target.pixel), target.weight);
  }
}
