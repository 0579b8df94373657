// GLSL only: the texel of an invocation, in passes over listed groups of texels.
#include "../lib/snow_shared.h"

/// A list from the texel_groups pass.
uniform usamplerBuffer groups;

int listed_group() { return int(texelFetch(groups, int(kGroupListBegin + gl_WorkGroupID.y)).x); }

/// In dispatches of blocks (kBlocksAGroup, y, 1).
int listed_texel() {
  return listed_group() * int(kTexelGroup) + int(gl_WorkGroupID.x * kBlock + gl_LocalInvocationID.x);
}
