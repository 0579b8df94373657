// GLSL only: the block of a work group, in dispatches over a list of blocks.
#include "../lib/repose_shared.h"
#include "../lib/texel_repose.h"

/// All lists; this one begins at list_begin and has the header heads[head].
uniform usamplerBuffer lists;
uniform int list_begin;
uniform int head;
layout(std430) buffer Heads { ReposeList heads[]; };

/// -1: none.
int listed_block() {
  const uint item = gl_WorkGroupID.x * kReposeListRows + gl_WorkGroupID.y;
  return item < heads[head].count ? int(texelFetch(lists, list_begin + int(item)).x) : -1;
}
