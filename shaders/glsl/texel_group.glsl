// GLSL only: which texel an invocation works on, in the passes over listed groups of texels.
#include "../lib/snow_shared.h"

/// A list as texel_groups leaves it.
uniform usamplerBuffer groups;

int listed_group() { return int(texelFetch(groups, int(kGroupListBegin + gl_WorkGroupID.y)).x); }

/// In dispatches of blocks (kBlocksAGroup, y, 1).
int listed_texel() {
  return listed_group() * int(kTexelGroup) + int(gl_WorkGroupID.x * kBlock + gl_LocalInvocationID.x);
}
