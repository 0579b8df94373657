// Classifies patches as dropped (outside the picture, of a branch level that is too far away, or smaller than the
// minimum number of pixels), plain (all edges at level 1) or tessellated. Counts the last two per work group.
#include "glsl/tree_view.glsl"
#include "glsl/count_classes.glsl"
#include "lib/snow_point.h"
#include "lib/tessellation.h"

layout(std430) readonly buffer PosedVertices { PosedVertex posed[]; };
layout(std430) readonly buffer TreePatches { TreePatch patches[]; };
layout(std430) readonly buffer EdgeLevels { float edge_levels[]; };
layout(std430) readonly buffer DeepestSnow { float deepest_snow[]; };

uint class_of(int index) {
  const TreePatch of = patches[index];
  const PosedVertex corners[4] =
      PosedVertex[4](posed[of.vertices.x], posed[of.vertices.y], posed[of.vertices.z], posed[of.vertices.w]);
  const vec3 centre =
      0.25 * (corners[0].position.xyz + corners[1].position.xyz + corners[2].position.xyz + corners[3].position.xyz);
  float radius = 0.0;
  float stretch = 0.0;
  for (int k = 0; k < 4; ++k) {
    radius = max(radius, distance(centre, corners[k].position.xyz));
    stretch = max(stretch, max(length(corners[k].row_x.xyz),
                               max(length(corners[k].row_y.xyz), length(corners[k].row_z.xyz))));
  }
  radius += of.rest[1].w * stretch + farthest_offset(deepest_snow[0]);
  if (is_unseen(centre, radius)) {
    return kDropped;
  }
  if (view.thesis.w > 0.5 && is_level_too_far(distance(view.eye.xyz, centre), float(of.place.y), view.thesis)) {
    return kDropped;
  }
  const float highest = max(max(edge_levels[of.edges.x >> 1], edge_levels[of.edges.y >> 1]),
                            max(edge_levels[of.edges.z >> 1], edge_levels[of.edges.w >> 1]));
  return highest > 1.0 ? kTessellated : kPlain;
}
