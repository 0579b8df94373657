// Classifies patches as dropped, plain (all edges at level 1) or tessellated, and counts the last two per work group.
// Dropped are patches outside the picture and plain ones that show their back. With the metric SCREEN thin limbs are
// dropped in part, and the others grow (lib/thin_limbs.h); the thesis's metric drops distant branch levels.
#include "glsl/tree_view.glsl"
#include "glsl/count_classes.glsl"
#include "lib/map_tiles.h"
#include "lib/snow_point.h"
#include "lib/tessellation.h"
#include "lib/thin_limbs.h"

#include "glsl/tree_base.glsl"
layout(std430) readonly buffer TreeSections { TreeSection sections[]; };
layout(std430) readonly buffer TreeEdges { TreeEdge edges[]; };
layout(std430) readonly buffer TreePatches { TreePatch patches[]; };
layout(std430) readonly buffer EdgeLevels { float edge_levels[]; };
/// The deepest snow of the tiles of all pages.
layout(std430) readonly buffer TileDepths { float tile_depths[]; };
layout(std430) writeonly buffer PatchGrowths { PatchGrowth growths[]; };
#include "glsl/limb_reach.glsl"

/// The deepest snow in a rectangle of the map.
float deepest_between(vec2 a, vec2 b) {
  const ivec2 map_size = tree.map.xy;
  const ivec2 tiles = (map_size + kSnowTile - 1) / kSnowTile;
  const vec2 scale = vec2(map_size) / float(kSnowTile);
  const vec2 texel = vec2(1.0 / float(kSnowTile));
  const ivec2 low = clamp(ivec2(floor(min(a, b) * scale - texel)), ivec2(0), tiles - 1);
  const ivec2 high = clamp(ivec2(floor(max(a, b) * scale + texel)), ivec2(0), tiles - 1);
  float deepest = 0.0;
  for (int y = low.y; y <= high.y; ++y) {
    for (int x = low.x; x <= high.x; ++x) {
      deepest = max(deepest, tile_depths[snow_tile(ivec2(x, y), tree.map)]);
    }
  }
  return deepest;
}

/// The deepest snow on a patch, including that of its neighbours along its edges.
float deepest_on(TreePatch of) {
  if (!has_snow()) {
    return 0.0;
  }
  float deepest = deepest_between(min(min(of.snow_uv_01.xy, of.snow_uv_01.zw), min(of.snow_uv_23.xy, of.snow_uv_23.zw)),
                                  max(max(of.snow_uv_01.xy, of.snow_uv_01.zw), max(of.snow_uv_23.xy, of.snow_uv_23.zw)));
  for (int k = 0; k < 4; ++k) {
    const TreeEdge edge = edges[tree.base.y + (of.edges[k] >> 1)];
    deepest = max(deepest, max(deepest_between(edge.snow_uv.xy, edge.snow_uv.zw),
                               deepest_between(edge.other_snow_uv.xy, edge.other_snow_uv.zw)));
  }
  return deepest;
}

/// True if a triangle shows its back.
bool is_behind(vec3 a, vec3 b, vec3 c) {
  return dot(cross(b - a, c - a), view.viewer.xyz - view.viewer.w * a) <= 0.0;
}

float edge_level(int edge) { return edge_levels[tree.own.y + (edge >> 1)]; }

uint class_of(WorkRange range, int index) {
  tree = instances[range.instance];
  const TreePatch of = patches[tree.base.z + index];
  vec3 corners[4];
  vec3 centre = vec3(0.0);
  float stretch = 0.0;
  for (int k = 0; k < 4; ++k) {
    const PosedVertex at = posed_of(of.vertices[k]);
    corners[k] = at.position.xyz;
    centre += 0.25 * corners[k];
    stretch = max(stretch, max(length(at.row_x.xyz), max(length(at.row_y.xyz), length(at.row_z.xyz))));
  }
  float radius = 0.0;
  for (int k = 0; k < 4; ++k) {
    radius = max(radius, distance(centre, corners[k]));
  }
  const float away = distance(view.eye.xyz, centre);
  const float highest = max(max(edge_level(of.edges.x), edge_level(of.edges.y)),
                            max(edge_level(of.edges.z), edge_level(of.edges.w)));
  if (view.thesis.w > 0.5 && is_level_too_far(away, float(of.limb.y), thesis_of_tree())) {
    return kDropped;
  }
  if (highest > 1.0) {
    radius += of.rest[1].w * stretch + farthest_offset(deepest_on(of), tree.style);
    return is_outside(centre, radius) ? kDropped : kTessellated;
  }
  const bool shows_back =
      is_behind(corners[0], corners[1], corners[2]) && is_behind(corners[0], corners[2], corners[3]);
  if (view.snow.w > 0.5 && shows_back) {
    return kDropped;
  }
  PatchGrowth growth = PatchGrowth(vec4(0.0, 0.0, 0.0, 1.0), vec4(1.0));
  if (view.thesis.w < 0.5) {
    float reach = 0.0;
    for (int k = 0; k < 4; ++k) {
      const vec3 middle = limb_middle(posed_of(of.vertices[k]), vertex_of(of.vertices[k]));
      growth.middle.xyz += 0.25 * middle;
      reach = max(reach, distance(middle, corners[k]));
    }
    const float least = view.tessellation.w;
    const float in_width = drawn_share(pixels_of(kDrawnWidth * reach, away), least);
    if (in_width < 1.0) {
      // Caps of thin limbs cover almost no pixels.
      if (of.limb.x < 0) {
        return kDropped;
      }
      const float in_length = drawn_share(pixels_of(sections[tree.base.w + of.limb.x].begin.w, away), kMinLength * least);
      growth.along.x = 1.0 / in_length;
      growth.middle.w = in_length * area_factor(in_width * in_length, of.rest[2].w);
      if (growth.middle.w <= 0.0) {
        return kDropped;
      }
      radius *= max(growth.middle.w, growth.along.x);
    }
  }
  growths[tree.own.z + index] = growth;
  return is_outside(centre, radius) ? kDropped : kPlain;
}
