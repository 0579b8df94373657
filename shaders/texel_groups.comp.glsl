// Lists the groups of texels that are active in this step: those that hold snow or have a triangle that faces the fall.
// The passes would change nothing in the others.
#include "lib/facing.h"
#include "lib/snow_shared.h"

layout(local_size_x = 64) in;
/// See TriangleSetup.
uniform samplerBuffer triangle_surface;
/// Triangles of group g: [group_begin[g], group_begin[g + 1]) of group_triangles.
uniform usamplerBuffer group_begin;
uniform usamplerBuffer group_triangles;
uniform uint group_count;
/// Lists every group.
uniform bool all_groups;
/// Per group: kHoldsSnow; the stability pass sets it again.
layout(std430) buffer GroupStates { uint group_states[]; };
layout(std430) buffer ActiveGroups { GroupListHeader active_header; uint active_groups[]; };

bool faces_the_fall(int group) {
  const int end = int(texelFetch(group_begin, group + 1).x);
  bool faces = false;
  for (int i = int(texelFetch(group_begin, group).x); i < end && !faces; ++i) {
    const int triangle = int(texelFetch(group_triangles, i).x);
    faces = may_face_the_fall(surface_facing(texelFetch(triangle_surface, triangle)));
  }
  return faces;
}

void main() {
  const uint group = gl_GlobalInvocationID.x;
  if (group >= group_count) {
    return;
  }
  if (all_groups || (group_states[group] & kHoldsSnow) != 0u || faces_the_fall(int(group))) {
    active_groups[atomicAdd(active_header.blocks.groups_y, 1u)] = group;
    atomicAdd(active_header.whole.groups_y, 1u);
    group_states[group] = 0u;
  }
}
