// The tessellation level of each edge of a receiver's base, once, so that both of its faces have the same.
#include "glsl/tree_view.glsl"
#include "lib/snow_patch.h"
#include "lib/tessellation.h"

layout(local_size_x = 64) in;
#include "glsl/item_index.glsl"
layout(std430) readonly buffer SnowVertices { SnowVertex vertices[]; };
layout(std430) readonly buffer SnowEdges { SnowEdge edges[]; };
layout(std430) readonly buffer SnowPatches { SnowPatch patches[]; };
layout(std430) readonly buffer PatchDepths { float patch_depths[]; };
layout(std430) writeonly buffer EdgeLevels { float edge_levels[]; };
uniform int count;

/// Parts beyond which a texel's own shape is told.
const float kPartsATexel = 2.0;

float thesis_patch_level(int index) {
  const ivec4 of = patches[index].vertices;
  const vec3 a = vertices[of.x].position.xyz;
  const vec3 b = vertices[of.y].position.xyz;
  const vec3 c = vertices[of.z].position.xyz;
  const vec3 across = cross(b - a, c - a);
  const vec4 clip_a = view.clip_from_world * vec4(a, 1.0);
  const vec4 clip_b = view.clip_from_world * vec4(b, 1.0);
  const vec4 clip_c = view.clip_from_world * vec4(c, 1.0);
  const float up = across.z / max(length(across), 1e-30);
  if (min(clip_a.w, min(clip_b.w, clip_c.w)) <= 0.0) {
    return up > 0.0 ? view.tessellation.y : 1.0;
  }
  const vec2 to_b = clip_b.xy / clip_b.w - clip_a.xy / clip_a.w;
  const vec2 to_c = clip_c.xy / clip_c.w - clip_a.xy / clip_a.w;
  return thesis_snow_level(up, 0.5 * abs(to_b.x * to_c.y - to_b.y * to_c.x), view.snow.x, view.tessellation.y);
}

void main() {
  const int index = item_index();
  if (index >= count) {
    return;
  }
  const SnowEdge edge = edges[index];
  const int one = edge.corners.x / 3;
  const int other = edge.corners.z / 3;
  const float depth = max(patch_depths[one], patch_depths[other]);
  float level = 1.0;
  if (uint(view.tessellation.x) == kMetricThesis) {
    level = max(thesis_patch_level(one), thesis_patch_level(other));
  } else if (depth > 0.0) {
    const vec3 a = vertices[edge.ends.x].position.xyz;
    const vec3 b = vertices[edge.ends.y].position.xyz;
    const float most = clamp(kPartsATexel * edge.metric.x, 1.0, view.tessellation.y);
    level = screen_level(distance(view.eye.xyz, 0.5 * (a + b)), distance(a, b), 0.0, view.eye.w,
                         view.tessellation.z, most);
  }
  edge_levels[index] = level;
}
