// Limits of the links across seams and over rims, at each of their ends.
#include "lib/repose_shared.h"
#include "lib/texel_repose.h"

layout(local_size_x = 64) in;
#include "glsl/item_index.glsl"
#include "glsl/repose_limit.glsl"
/// In metres.
uniform samplerBuffer positions;
/// A SceneTriangle each.
uniform usamplerBuffer triangles;
/// A ReposeBlock each.
uniform usamplerBuffer blocks;
// See repose_cells.
uniform samplerBuffer points;
uniform samplerBuffer slopes;
uniform samplerBuffer cells;
/// A ReposeEnd each, as two vectors.
uniform usamplerBuffer ends;
uniform int end_count;
uniform int first_slot;
layout(std430) readonly buffer Objects { ReposeObject objects[]; };
/// Height of the rim or wall, limit, rate of flow, kind.
layout(std430) writeonly buffer EndLimits { vec4 end_limits[]; };

/// The point of the seam or rim.
vec3 edge_point(uvec4 end, uvec4 rest) {
  const uvec4 corners = texelFetch(triangles, int(end.z));
  const uint slot = texelFetch(blocks, int(end.x) / kReposeCells).w;
  const vec3 a = texelFetch(positions, int(corners.x)).xyz;
  const vec3 b = texelFetch(positions, int(corners.y)).xyz;
  const vec3 c = texelFetch(positions, int(corners.z)).xyz;
  const vec2 weights = uintBitsToFloat(uvec2(end.w, rest.x));
  return (a - objects[int(slot) - first_slot].anchor.xyz) + weights.x * (b - a) + weights.y * (c - a);
}

vec4 end_limit(uvec4 end, uvec4 rest) {
  const int own = int(end.x);
  const vec4 a = texelFetch(points, own);
  const vec4 slope = texelFetch(slopes, own);
  const vec4 cell = texelFetch(cells, own);
  if (cell.y == 0.0) {
    return vec4(0.0);
  }
  if (end.y != kNowhere) {
    const vec4 b = texelFetch(points, int(end.y));
    const vec4 other_slope = texelFetch(slopes, int(end.y));
    const vec4 other = texelFetch(cells, int(end.y));
    if (b.w > 0.0 && other.y != 0.0) {
      const float limit = limit_between(a.xyz, b.xyz, 0.5 * (slope.z + other_slope.z),
                                        0.5 * (bare_slope(slope.y) + bare_slope(other_slope.y)), kAllLeadDown);
      return vec4(0.0, limit, min(cell.w, other.w), kEndAtSeam);
    }
    if (!(b.w > 0.0 && b.z < a.z)) {
      return vec4(0.0);
    }
  }
  const vec3 edge = edge_point(end, rest);
  return vec4(edge.z, limit_between(a.xyz, edge, slope.z, bare_slope(slope.y), kAllLeadDown), cell.w, kEndAtOutlet);
}

void main() {
  const int end = item_index();
  if (end < end_count) {
    end_limits[end] = end_limit(texelFetch(ends, 2 * end), texelFetch(ends, 2 * end + 1));
  }
}
