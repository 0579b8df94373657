// The tree's surface. Vertices come from their pose, and points within a patch from the patch. Points of edges come
// from the edge's record alone, so that both faces of an edge compute the same bits.
//
// SNOW: adds the snow of trees that have some on top of the bark.
#include "glsl/bark.glsl"
#include "glsl/tree_view.glsl"
#include "glsl/limb_growth.glsl"
#include "lib/limb_section.h"
#ifdef SNOW
#include "glsl/tree_snow.glsl"
#endif

#include "glsl/tree_base.glsl"
layout(std430) readonly buffer TreeSections { TreeSection sections[]; };
layout(std430) readonly buffer TreeEdges { TreeEdge edges[]; };
layout(std430) readonly buffer TreePatches { TreePatch patches[]; };

struct SurfacePoint {
  /// Posed position, including bark and snow.
  vec3 position;
  /// Posed normal of the limb without bark.
  vec3 normal;
  /// Circumference of the limb, and amplitude of its bark (m).
  vec2 limb;
  /// Position in the rest pose, without bark.
  vec3 rest;
  /// See limb_noise.
  vec4 noise;
};

/// A point in the rest pose.
struct RestPoint {
  vec3 position;
  vec3 normal;
  vec2 bark_uv;
  float circumference;
  float bark;
  /// Thickness from the snow map (m).
  float snow;
  vec4 row_x;
  vec4 row_y;
  vec4 row_z;
};

/// Poses a point and adds bark and snow. Tessellated vertices are a few pixels apart, which gives the number of samples
/// around the limb.
SurfacePoint on_bark(RestPoint rest) {
  const vec4 p = vec4(rest.position, 1.0);
  precise vec3 bare = vec3(dot(rest.row_x, p), dot(rest.row_y, p), dot(rest.row_z, p));
  const vec3 n = rest.normal;
  const vec3 normal = normalize(
      vec3(dot(vec3(rest.row_x), n), dot(vec3(rest.row_y), n), dot(vec3(rest.row_z), n)));
  const float away = max(distance(bare, vec3(view.eye)), 1e-6);
  const float samples = rest.circumference * view.eye.w / (away * view.tessellation.z);
  float height = 0.0;
  if (rest.bark > 0.0) {
    height = rest.bark * bark_height(rest.bark_uv, samples);
  }
  height += square_growth(rest.circumference, away);
  precise vec3 position = bare + normal * height;
  vec4 noise = vec4(0.0);
#ifdef SNOW
  if (has_snow()) {
    noise = limb_noise(rest.position);
    position += snow_offset(limb_point(noise, rest.circumference), max(rest.snow, 0.0), normal);
  }
#endif
  return SurfacePoint(position, normal, vec2(rest.circumference, rest.bark), rest.position, noise);
}

SurfacePoint vertex_point(int index) {
  const PosedVertex at = posed_of(index);
  const vec3 rest = vec3(vertex_of(index).position);
  vec4 noise = vec4(0.0);
#ifdef SNOW
  if (has_snow()) {
    noise = limb_noise(rest);
  }
#endif
  return SurfacePoint(vec3(at.position), vec3(at.normal), vec2(at.normal.w, at.position.w), rest, noise);
}

/// The point at fraction t, within 0 and 1, between an edge's first and last vertex.
SurfacePoint edge_point(int index, float t) {
  const TreeEdge edge = edges[tree.base.y + index];
  const TreeVertex a = vertex_of(edge.ends.x);
  const TreeVertex b = vertex_of(edge.ends.y);
  const PosedVertex pose_a = posed_of(edge.ends.x);
  const PosedVertex pose_b = posed_of(edge.ends.y);
  const float s = edge.first_rest.w > 0.5 ? chord_share(t) : t;
  const vec3 p = mix(vec3(a.position), vec3(b.position), s);
  vec3 round_point = p;
  if (edge.ends.z >= 0) {
    round_point = on_limb(sections[tree.base.w + edge.ends.z], p);
  }
  if (edge.ends.w >= 0) {
    round_point = 0.5 * (round_point + on_limb(sections[tree.base.w + edge.ends.w], p));
  }
  RestPoint rest;
  rest.position =
      round_point + rest_share(t) * vec3(edge.first_rest) + rest_share(1.0 - t) * vec3(edge.last_rest);
  rest.normal = mix(vec3(a.normal), vec3(b.normal), s);
  rest.bark_uv = mix(edge.bark_uv.xy, edge.bark_uv.zw, t);
  rest.circumference = mix(a.normal.w, b.normal.w, s);
  rest.bark = mix(a.position.w, b.position.w, s) * edge.metric.z;
  rest.snow = 0.0;
#ifdef SNOW
  if (has_snow()) {
    rest.snow = 0.5 * (height_between(mix(edge.snow_uv.xy, edge.snow_uv.zw, t)) +
                       height_between(mix(edge.other_snow_uv.xy, edge.other_snow_uv.zw, t)));
  }
#endif
  rest.row_x = mix(pose_a.row_x, pose_b.row_x, s);
  rest.row_y = mix(pose_a.row_y, pose_b.row_y, s);
  rest.row_z = mix(pose_a.row_z, pose_b.row_z, s);
  return on_bark(rest);
}

vec4 bilinear(vec4 a, vec4 b, vec4 c, vec4 d, vec2 at) {
  return mix(mix(a, b, at.x), mix(d, c, at.x), at.y);
}

/// Interpolates coordinates within a patch from corners 0 and 1, 2 and 3.
vec2 patch_uv(vec4 uv_01, vec4 uv_23, vec2 at) {
  return mix(mix(uv_01.xy, uv_01.zw, at.x), mix(uv_23.zw, uv_23.xy, at.x), at.y);
}

/// The bark's coordinates on the patch's own side of a seam.
vec2 patch_bark_uv(TreePatch of, vec2 at) {
  return patch_uv(of.bark_uv_01, of.bark_uv_23, at);
}

/// The patch's coordinates on the snow map.
vec2 patch_snow_uv(TreePatch of, vec2 at) {
  return patch_uv(of.snow_uv_01, of.snow_uv_23, at);
}

/// A point within a patch, not on its edges.
SurfacePoint inner_point(TreePatch of, vec2 at) {
  const float round_share = of.limb.w == kWallPatch ? 1.0 : of.limb.w == kRoundInset ? 1.0 - at.y : 0.0;
  const vec2 s = vec2(mix(at.x, chord_share(at.x), round_share), at.y);
  const ivec4 v = tree.base.x + of.vertices;
  const ivec4 w = tree.own.x + of.vertices;
  const vec4 p = bilinear(vertices[v.x].position, vertices[v.y].position, vertices[v.z].position,
                          vertices[v.w].position, s);
  const vec4 n =
      bilinear(vertices[v.x].normal, vertices[v.y].normal, vertices[v.z].normal, vertices[v.w].normal, s);
  vec3 round_point = vec3(p);
  if (of.limb.x >= 0) {
    round_point = on_limb(sections[tree.base.w + of.limb.x], vec3(p));
  }
  const vec2 low = vec2(rest_share(at.x), rest_share(at.y));
  const vec2 high = vec2(rest_share(1.0 - at.x), rest_share(1.0 - at.y));
  round_point += low.x * low.y * vec3(of.rest[0]) + high.x * low.y * vec3(of.rest[1]) +
                 high.x * high.y * vec3(of.rest[2]) + low.x * high.y * vec3(of.rest[3]);
  RestPoint rest;
  rest.position = round_point;
  rest.normal = vec3(n) + vec3(of.normal) * (16.0 * at.x * (1.0 - at.x) * at.y * (1.0 - at.y));
  rest.bark_uv = patch_bark_uv(of, at);
  rest.circumference = n.w;
  rest.bark = p.w;
  rest.snow = 0.0;
#ifdef SNOW
  if (has_snow()) {
    rest.snow = height_between(patch_snow_uv(of, at));
  }
#endif
  rest.row_x = bilinear(posed[w.x].row_x, posed[w.y].row_x, posed[w.z].row_x, posed[w.w].row_x, s);
  rest.row_y = bilinear(posed[w.x].row_y, posed[w.y].row_y, posed[w.z].row_y, posed[w.w].row_y, s);
  rest.row_z = bilinear(posed[w.x].row_z, posed[w.y].row_z, posed[w.z].row_z, posed[w.w].row_z, s);
  return on_bark(rest);
}

/// The point of a patch at the tessellator's coordinates: a vertex, a point of an edge, or an inner point.
SurfacePoint patch_point(TreePatch of, vec2 at) {
  const bool left = at.x <= 0.0;
  const bool right = at.x >= 1.0;
  const bool low = at.y <= 0.0;
  const bool high = at.y >= 1.0;
  if ((left || right) && (low || high)) {
    return vertex_point(low ? (left ? of.vertices.x : of.vertices.y) : (left ? of.vertices.w : of.vertices.z));
  }
  if (left || right || low || high) {
    const int edge = low ? of.edges.x : right ? of.edges.y : high ? of.edges.z : of.edges.w;
    const float along = low ? at.x : right ? at.y : high ? 1.0 - at.x : 1.0 - at.y;
    return edge_point(edge >> 1, (edge & 1) != 0 ? 1.0 - along : along);
  }
  return inner_point(of, at);
}
