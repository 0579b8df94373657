// The tessellation level of each edge, computed once, so that both faces have the same.
#include "glsl/tree_view.glsl"
#include "lib/tessellation.h"

layout(local_size_x = 64) in;
#include "glsl/item_index.glsl"
layout(std430) readonly buffer PosedVertices { PosedVertex posed[]; };
layout(std430) readonly buffer TreeEdges { TreeEdge edges[]; };
layout(std430) writeonly buffer EdgeLevels { float edge_levels[]; };
uniform int count;

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
    edge_levels[index] = thesis_level(away, edge.metric.x, edge.metric.y, view.thesis, highest);
  } else {
    const float chord = distance(a.xyz, b.xyz);
    const float target = view.tessellation.z;
    float level = screen_level(away, chord, max(a.w, b.w) * edge.metric.z, view.eye.w, target, highest);
    if (edge.first_rest.w > 0.5) {
      level = max(level, outline_level(away, chord, view.eye.w, target, highest));
    }
    edge_levels[index] = level;
  }
}
