// Computes the tessellation level of each edge once, so that both of its faces use the same level.
//
// SNOW: the thesis's metric also has a level for snow.
#include "glsl/tree_view.glsl"
#include "lib/tessellation.h"
#include "lib/thin_limbs.h"

#include "glsl/work_range.glsl"
#include "glsl/tree_base.glsl"
layout(std430) readonly buffer TreeEdges { TreeEdge edges[]; };
layout(std430) writeonly buffer EdgeLevels { float edge_levels[]; };
#include "glsl/limb_reach.glsl"

/// The fraction of its level that an edge gets.
float round_share_of(TreeEdge edge, float away) {
  if (view.tessellation.w == 0.0) {
    return 1.0;
  }
  float reach = 0.0;
  for (int k = 0; k < 2; ++k) {
    const PosedVertex at = posed_of(edge.ends[k]);
    reach = max(reach, distance(at.position.xyz, limb_middle(at, vertex_of(edge.ends[k]))));
  }
  const float width = pixels_of(2.0 * reach, away);
#ifdef SNOW
  if (has_snow()) {
    return snowy_round_share(width, pixels_of(tree.snow.x, away), view.tessellation.z);
  }
#endif
  return round_share(width, view.tessellation.z);
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
  const WorkRange range = work_range();
  const int index = work_slot() - range.first_slot;
  if (index >= range.count) {
    return;
  }
  tree = instances[range.instance];
  const TreeEdge edge = edges[tree.base.y + index];
  const vec4 a = posed_of(edge.ends.x).position;
  const vec4 b = posed_of(edge.ends.y).position;
  float edge_level;
  const float away = distance(view.eye.xyz, 0.5 * (a.xyz + b.xyz));
  const float highest = view.tessellation.y;
  if (uint(view.tessellation.x) == kMetricThesis) {
    float level = thesis_level(away, edge.metric.x, edge.metric.y, thesis_of_tree(), highest);
#ifdef SNOW
    if (has_snow()) {
      level = max(level, snow_level(edge, posed_of(edge.ends.x), posed_of(edge.ends.y)));
    }
#endif
    edge_level = level;
  } else {
    const float chord = distance(a.xyz, b.xyz);
    const float target = view.tessellation.z;
    float level = screen_level(away, chord, max(a.w, b.w) * edge.metric.z, view.eye.w, target, highest);
    if (edge.first_rest.w > 0.5) {
      level = max(level, outline_level(away, chord, view.eye.w, target, highest));
    }
    edge_level = 1.0 + (level - 1.0) * round_share_of(edge, away);
  }
  edge_levels[tree.own.y + index] = edge_level;
}
