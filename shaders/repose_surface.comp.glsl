// The bare surface of a batch's texels in the current pose, for repose: see ReposeSurface in native/snow/repose. Only of
// receivers that have moved.
#include "lib/kernel.h"
#include "lib/repose_shared.h"
#include "glsl/texel_place.glsl"

layout(local_size_x = 64) in;
#include "glsl/item_index.glsl"
/// In metres.
uniform samplerBuffer positions;
/// A SceneTriangle each.
uniform usamplerBuffer triangles;
uniform usamplerBuffer fragment_begin;
/// One Fragment per element.
uniform usamplerBuffer fragments;
/// Per texel: layer * resolution^2 + row * resolution + column, kNowhere after an object's last.
uniform usamplerBuffer places;
/// Per group of texels: the slot of its object.
uniform usamplerBuffer group_slots;
#ifdef WITH_SHADING
/// See smooth_points.h.
uniform usamplerBuffer triangle_points;
uniform samplerBuffer point_normals;
#ifdef WITH_CURVATURE
uniform samplerBuffer point_curvatures;
#endif
#endif
uniform int texel_count;
uniform int resolution;
/// Slots of the receivers in these passes.
uniform int first_slot;
uniform int end_slot;
layout(std430) readonly buffer Objects { ReposeObject objects[]; };
layout(std430) readonly buffer Tables { uint block_numbers[]; };
/// Per cell: point relative to the object's anchor, and covered area in m2.
layout(std430) writeonly buffer Points { vec4 points[]; };
/// Per cell: upward part of the shading normal, the same for the capacity, sum of the principal curvatures in 1/m, 1 if
/// the texel takes snow on both sides.
layout(std430) writeonly buffer Slopes { vec4 slopes[]; };

struct Corners {
  vec3 a;
  vec3 b;
  vec3 c;
  bool two_sided;
};

Corners corners_of(int triangle, vec3 anchor) {
  const uvec4 own = texelFetch(triangles, triangle);
  return Corners(texelFetch(positions, int(own.x)).xyz - anchor, texelFetch(positions, int(own.y)).xyz - anchor,
                 texelFetch(positions, int(own.z)).xyz - anchor, (own.w & kTwoSided) != 0u);
}

/// xyz: shading normal at a point of a triangle, w: curvature. With face normals snow would form terraces.
vec4 shading_at(int triangle, vec2 weights, vec3 own) {
#ifdef WITH_SHADING
  const uvec4 corners = texelFetch(triangle_points, triangle);
  if (corners.x != kNowhere) {
    const vec3 a = texelFetch(point_normals, int(corners.x)).xyz;
    const vec3 mean = a + weights.x * (texelFetch(point_normals, int(corners.y)).xyz - a) +
                      weights.y * (texelFetch(point_normals, int(corners.z)).xyz - a);
    const float size = length(mean);
    float curvature = 0.0;
#ifdef WITH_CURVATURE
    curvature = (texelFetch(point_curvatures, int(corners.x)).x + texelFetch(point_curvatures, int(corners.y)).x +
                 texelFetch(point_curvatures, int(corners.z)).x) / 3.0;
#endif
    return vec4(size > 0.0 && dot(mean, own) > 0.0 ? mean / size : own, curvature);
  }
#endif
  return vec4(own, 0.0);
}

int cell_of(ivec3 at, ReposeObject object) {
  const uint block = block_numbers[int(object.table) + (at.y >> kReposeBlockBits) * int(object.blocks_a_side) +
                                   (at.x >> kReposeBlockBits)];
  return int(block) * kReposeCells + (at.y & (kReposeBlock - 1)) * kReposeBlock + (at.x & (kReposeBlock - 1));
}

void main() {
  const int texel = item_index();
  if (texel >= texel_count) {
    return;
  }
  const int slot = int(texelFetch(group_slots, texel / int(kTexelGroup)).x);
  const uint place = texelFetch(places, texel).x;
  if (place == kNowhere || slot < first_slot || slot >= end_slot || objects[slot - first_slot].has_moved == 0u) {
    return;
  }
  const ReposeObject object = objects[slot - first_slot];
  const int begin = int(texelFetch(fragment_begin, texel).x);
  const int end = int(texelFetch(fragment_begin, texel + 1).x);
  float area = 0.0;
  float sum_up = 0.0;
  float upper = 0.0;
  float upper_up = 0.0;
  bool two_sided = false;
  for (int f = begin; f < end; ++f) {
    const uvec4 fragment = texelFetch(fragments, f);
    const Corners corners = corners_of(int(fragment.x), object.anchor.xyz);
    const vec3 across = cross(corners.b - corners.a, corners.c - corners.a);
    const float size = length(across);
    const float own = uintBitsToFloat(fragment.y) * 0.5 * size;
    const float up = size > 0.0 ? across.z / size : 0.0;
    area += own;
    sum_up += own * up;
    upper += up > 0.0 ? own : 0.0;
    upper_up += own * max(up, 0.0);
    two_sided = two_sided || corners.two_sided;
  }
  vec3 point = vec3(0.0);
  vec3 normal = vec3(0.0);
  float curvature = 0.0;
  float capacity_up = 0.0;
  if (area > 0.0) {
    // Snow lies on parts that face up, if there are any; on two-sided sheets, on one side.
    upper = two_sided ? 0.0 : upper;
    capacity_up = (!two_sided && upper_up > 0.0 ? upper_up : sum_up) / area;
    const float all = upper > 0.0 ? upper : area;
    for (int f = begin; f < end; ++f) {
      const uvec4 fragment = texelFetch(fragments, f);
      const Corners corners = corners_of(int(fragment.x), object.anchor.xyz);
      const vec3 across = cross(corners.b - corners.a, corners.c - corners.a);
      const float size = length(across);
      const vec3 own = size > 0.0 ? across / size : vec3(0.0);
      if (upper > 0.0 && own.z <= 0.0) {
        continue;
      }
      const float part = uintBitsToFloat(fragment.y) * 0.5 * size / all;
      const vec2 weights = uintBitsToFloat(fragment.zw);
      point += part * (corners.a + weights.x * (corners.b - corners.a) + weights.y * (corners.c - corners.a));
      const vec4 shading = shading_at(int(fragment.x), weights, own);
      normal += part * shading.xyz;
      curvature += part * shading.w;
    }
    const float size = length(normal);
    normal = size > 0.0 ? normal / size : normal;
  }
  const int cell = cell_of(decoded_place(place, resolution, 1.0 / float(resolution)), object);
  points[cell] = vec4(point, area);
  slopes[cell] = vec4(normal.z, capacity_up, curvature, two_sided ? 1.0 : 0.0);
}
