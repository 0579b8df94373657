// Tessellation levels of a patch. The outer ones come from the records of its edges; each inner one is the higher of
// two opposite outer ones.
#include "lib/tree_shared.h"

layout(vertices = 1) out;
layout(std430) readonly buffer TreePatches { TreePatch patches[]; };
layout(std430) readonly buffer EdgeLevels { float edge_levels[]; };
in uint listed_patch[];
patch out uint patch_index;

void main() {
  patch_index = listed_patch[0];
  const ivec4 edges = patches[patch_index].edges;
  const vec4 levels = vec4(edge_levels[edges.x >> 1], edge_levels[edges.y >> 1], edge_levels[edges.z >> 1],
                           edge_levels[edges.w >> 1]);
  // The patch's edges are at v = 0, u = 1, v = 1 and u = 0; OpenGL starts at u = 0.
  gl_TessLevelOuter[0] = levels.w;
  gl_TessLevelOuter[1] = levels.x;
  gl_TessLevelOuter[2] = levels.y;
  gl_TessLevelOuter[3] = levels.z;
  gl_TessLevelInner[0] = max(levels.x, levels.z);
  gl_TessLevelInner[1] = max(levels.y, levels.w);
}
