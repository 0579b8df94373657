// Computes the tessellation level of each edge once, so that both of its faces use the same level.
//
// SNOW: the thesis's metric also has a level for snow.
#include "glsl/tree_view.glsl"
#include "lib/tessellation.h"
#include "lib/thin_limbs.h"

layout(local_size_x = 64) in;
#include "glsl/item_index.glsl"
layout(std430) readonly buffer PosedVertices { PosedVertex posed[]; };
layout(std430) readonly buffer TreeVertices { TreeVertex vertices[]; };
layout(std430) readonly buffer TreeEdges { TreeEdge edges[]; };
layout(std430) writeonly buffer EdgeLevels { float edge_levels[]; };
uniform int count;
#include "glsl/limb_reach.glsl"

/// The fraction of its level that an edge gets.
float round_share_of(TreeEdge edge, float away) {
  if (view.tessellation.w == 0.0) {
    return 1.0;
  }
  float reach = 0.0;
  for (int k = 0; k < 2; ++k) {
    const PosedVertex at = posed[edge.ends[k]];
    reach = max(reach, distance(at.position.xyz, limb_middle(at, vertices[edge.ends[k]])));
  }
  const float width = pixels_of(2.0 * reach, away);
#ifdef SNOW
  return snowy_round_share(width, pixels_of(view.snow.y, away), view.tessellation.z);
#else
  return round_share(width, view.tessellation.z);
#endif
}

#ifdef SNOW
/// The thesis's level for snow on the faces of an edge from a to b. It uses a rectangle beside the edge with the mean
/// area of the faces and the orientation of the edge's ends.
float snow_level(TreeEdge edge, PosedVertex a, PosedVertex b) {
  const vec3 along = b.position.xyz - a.position.xyz;
  const vec3 normal = normalize(a.normal.xyz + b.normal.xyz);
  const vec3 aside = cross(normal, along) * (edge.metric.x / max(dot(along, along), 1e-12));
  const vec4 clip_a = view.clip_from_world * vec4(a.position.xyz, 1.0);
  const vec4 clip_b = view.clip_from_world * vec4(b.position.xyz, 1.0);
  const vec4 clip_c = view.clip_from_world * vec4(a.position.xyz + aside, 1.0);
  if (min(clip_a.w, min(clip_b.w, clip_c.w)) <= 0.0) {
    return normal.z > 0.0 ? view.tessellation.y : 1.0;
  }
  const vec2 to_b = clip_b.xy / clip_b.w - clip_a.xy / clip_a.w;
  const vec2 to_c = clip_c.xy / clip_c.w - clip_a.xy / clip_a.w;
  return thesis_snow_level(normal.z, abs(to_b.x * to_c.y - to_b.y * to_c.x), view.snow.x, view.tessellation.y);
}
#endif

void main() {
  const int index = item_index();
  if (index >= count) {
    return;
  }
  const TreeEdge edge = edges[index];
  const vec4 a = posed[edge.ends.x].position;
  const vec4 b = posed[edge.ends.y].position;
  const float away = distance(view.eye.xyz, 0.5 * (a.xyz + b.xyz));
  const float highest = view.tessellation.y;
  if (uint(view.tessellation.x) == kMetricThesis) {
    float level = thesis_level(away, edge.metric.x, edge.metric.y, view.thesis, highest);
#ifdef SNOW
    level = max(level, snow_level(edge, posed[edge.ends.x], posed[edge.ends.y]));
#endif
    edge_levels[index] = level;
  } else {
    const float chord = distance(a.xyz, b.xyz);
    const float target = view.tessellation.z;
    float level = screen_level(away, chord, max(a.w, b.w) * edge.metric.z, view.eye.w, target, highest);
    if (edge.first_rest.w > 0.5) {
      level = max(level, outline_level(away, chord, view.eye.w, target, highest));
    }
    edge_levels[index] = 1.0 + (level - 1.0) * round_share_of(edge, away);
  }
}
