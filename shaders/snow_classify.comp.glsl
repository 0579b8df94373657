// Sorts a receiver's patches into dropped (outside of the picture with all of their snow, or below some pixels), plain
// (all edges at level 1) and tessellated, and counts the latter two for each work group.
#include "glsl/tree_view.glsl"
#include "glsl/count_classes.glsl"
#include "lib/snow_patch.h"

layout(std430) readonly buffer SnowVertices { SnowVertex vertices[]; };
layout(std430) readonly buffer SnowPatches { SnowPatch patches[]; };
layout(std430) readonly buffer PatchDepths { float patch_depths[]; };
layout(std430) readonly buffer EdgeLevels { float edge_levels[]; };

uint class_of(int index) {
  const SnowPatch of = patches[index];
  const vec3 a = vertices[of.vertices.x].position.xyz;
  const vec3 b = vertices[of.vertices.y].position.xyz;
  const vec3 c = vertices[of.vertices.z].position.xyz;
  const vec3 centre = (a + b + c) / 3.0;
  const float radius = max(distance(centre, a), max(distance(centre, b), distance(centre, c)));
  if (is_unseen(centre, radius + (1.0 + kMostBend) * patch_depths[index])) {
    return kDropped;
  }
  const float highest = max(edge_levels[of.edges.x >> 1], max(edge_levels[of.edges.y >> 1], edge_levels[of.edges.z >> 1]));
  return highest > 1.0 ? kTessellated : kPlain;
}
