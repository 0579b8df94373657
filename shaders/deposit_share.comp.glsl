// Last part of the deposit, for every tile but the last, whose shares the stability pass takes itself.
#include "texel_group.h"
#include "texel_share.h"

layout(local_size_x = 64) in;
/// Thickness in metres; 0 at the start of a step.
layout(std430) writeonly buffer DepositShare { float deposit_share[]; };
/// A TexelStep each.
uniform usamplerBuffer texel_steps;

void main() {
  const int index = listed_texel();
  const uvec4 step = texelFetch(texel_steps, index);
  if (step.y != 0u) {
    deposit_share[index] = share_of(step.xy, uintBitsToFloat(step.z));
  }
}
