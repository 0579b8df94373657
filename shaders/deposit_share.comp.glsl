// Last part of the deposit, for every tile but the last, whose shares the stability pass takes itself.
#include "texel_group.h"
#include "texel_share.h"

layout(local_size_x = 64) in;
/// Thickness in metres; 0 at the start of a step.
layout(std430) writeonly buffer DepositShare { float deposit_share[]; };
uniform samplerBuffer texel_surface;
uniform usamplerBuffer targets;

void main() {
  const int index = listed_texel();
  const uvec2 target = texelFetch(targets, index).xy;
  if (target.y != 0u) {
    deposit_share[index] = share_of(target, texelFetch(texel_surface, index).w);
  }
}
