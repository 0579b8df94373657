// Tessellation levels of a patch. The outer ones come from the records of its edges; each inner one is the higher of
// two opposite outer ones.
#include "lib/tree_shared.h"

layout(vertices = 1) out;
layout(std430) readonly buffer TreePatches { TreePatch patches[]; };
layout(std430) readonly buffer EdgeLevels { float edge_levels[]; };
#include "glsl/tree_instance.glsl"
in ivec2 listed_patch[];
/// Instance, and number of the patch in its base.
patch out ivec2 drawn_patch;

void main() {
  drawn_patch = listed_patch[0];
  tree = instances[drawn_patch.x];
  const ivec4 edges = tree.own.y + (patches[tree.base.z + drawn_patch.y].edges >> 1);
  const vec4 levels =
      vec4(edge_levels[edges.x], edge_levels[edges.y], edge_levels[edges.z], edge_levels[edges.w]);
  // The patch's edges are at v = 0, u = 1, v = 1 and u = 0; OpenGL starts at u = 0.
  gl_TessLevelOuter[0] = levels.w;
  gl_TessLevelOuter[1] = levels.x;
  gl_TessLevelOuter[2] = levels.y;
  gl_TessLevelOuter[3] = levels.z;
  gl_TessLevelInner[0] = max(levels.x, levels.z);
  gl_TessLevelInner[1] = max(levels.y, levels.w);
}
