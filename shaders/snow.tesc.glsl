// Levels of a patch: outside those of its edges' records, inside the highest of them.
#include "lib/snow_patch.h"

layout(vertices = 1) out;
layout(std430) readonly buffer SnowPatches { SnowPatch patches[]; };
layout(std430) readonly buffer EdgeLevels { float edge_levels[]; };
in uint listed_patch[];
patch out uint patch_index;

void main() {
  patch_index = listed_patch[0];
  const ivec4 edges = patches[patch_index].edges;
  const vec3 levels = vec3(edge_levels[edges.x >> 1], edge_levels[edges.y >> 1], edge_levels[edges.z >> 1]);
  // Edge k runs from corner k to k + 1; OpenGL counts them by the corner opposite.
  gl_TessLevelOuter[0] = levels.y;
  gl_TessLevelOuter[1] = levels.z;
  gl_TessLevelOuter[2] = levels.x;
  gl_TessLevelInner[0] = max(levels.x, max(levels.y, levels.z));
}
