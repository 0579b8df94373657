#pragma once

// Snow on smooth-shaded surfaces, at their smooth points: the corners that share a normal. Thickness is interpolated
// between them, so that it shows no facets, and the total on the smooth surface equals the total on the flat triangles:
// each triangle distributes its snow to its three points, by how far their smooth normals face the fall, and a point
// spreads its snow over its third of the triangles around it. Keeping the sum per triangle would show terraces: the two
// halves of a quad of a ball are equally steep, and hold different amounts.
#include "facing.h"
#include "kernel.h"
#include "projection_frame.h"
#include "snow_shared.h"

/// In metres.
KERNEL_VIEW_RGB32F(positions);
/// A SceneTriangle each.
KERNEL_VIEW_RGBA32UI(triangles);
/// The smooth points at every triangle's corners, kNowhere if it is shaded flat.
KERNEL_VIEW_RGBA32UI(triangle_points);
/// The corners (3 * triangle + corner) of point p: [point_begin[p], point_begin[p + 1]) of point_corners.
KERNEL_VIEW_R32UI(point_begin);
KERNEL_VIEW_R32UI(point_corners);
/// See TriangleSetup.
KERNEL_VIEW_RGBA32F(triangle_surface);
/// Per point: its smooth normal from smooth_normal.
KERNEL_VIEW_RGBA32F(point_normals);

/// Weight of a corner whose smooth normal does not face the fall.
KERNEL_CONSTANT float kMinShare = 1e-4f;

/// The angle with this sine and cosine, up to a common factor, 0 to pi; `sine` is not negative. Within 1e-5: M.
/// Abramowitz, I. A. Stegun, Handbook of Mathematical Functions, 4.4.49. Written out so that every driver gives the
/// same result.
float angle_of(float sine, float cosine) {
  const float high = max(sine, abs(cosine));
  if (!(high > 0.0f)) {
    return 0.0f;
  }
  const float x = min(sine, abs(cosine)) / high;
  const float y = x * x;
  const float below = x * (0.9998660f + y * (-0.3302995f + y * (0.1801410f + y * (-0.0851330f + y * 0.0208351f))));
  const float acute = sine > abs(cosine) ? 1.57079633f - below : below;
  return cosine < 0.0f ? 3.14159265f - acute : acute;
}

vec3 position_of(uint vertex) { return vec3(texelFetch(positions, int(vertex))); }

vec3 unit_or_zero(vec3 v) {
  // Scaled first: the square of a very short edge underflows.
  const float scale = max(abs(v.x), max(abs(v.y), abs(v.z)));
  return scale > 0.0f ? normalize(v / scale) : vec3(0.0f);
}

/// A triangle's normal times its angle at a corner.
vec3 corner_normal(uint corner) {
  const uvec4 triangle = uvec4(texelFetch(triangles, int(corner / 3u)));
  const uint k = corner % 3u;
  const vec3 own = position_of(k == 0u ? triangle.x : k == 1u ? triangle.y : triangle.z);
  const vec3 after = unit_or_zero(position_of(k == 0u ? triangle.y : k == 1u ? triangle.z : triangle.x) - own);
  const vec3 before = unit_or_zero(position_of(k == 0u ? triangle.z : k == 1u ? triangle.x : triangle.y) - own);
  const vec3 across = cross(after, before);
  const float sine = length(across);
  return sine > 0.0f ? across * (angle_of(sine, dot(after, before)) / sine) : vec3(0.0f);
}

/// The unit normal of a smooth point: the mean of its triangles' normals, weighted by their angles there. Source: G.
/// Thuermer, C. A. Wuethrich, Computing Vertex Normals from Polygonal Facets, Journal of Graphics Tools 3(1), 1998.
vec4 smooth_normal(int point) {
  const int end = int(texelFetch(point_begin, point + 1).x);
  vec3 sum = vec3(0.0f);
  for (int i = int(texelFetch(point_begin, point).x); i < end; ++i) {
    sum += corner_normal(texelFetch(point_corners, i).x);
  }
  return vec4(unit_or_zero(sum), 0.0f);
}

/// Cosine between a point's normal, turned to the side that faces the sky, and the direction to the sky.
float facing_of(uint point, float side) {
  const vec3 normal = vec3(texelFetch(point_normals, int(point)));
  return max(0.0f, -side * dot(normal, vec3(projection.direction))) + kMinShare;
}

/// The part of a triangle's snow that a corner gets.
float corner_share(uint corner, float side) {
  const uvec4 points = uvec4(texelFetch(triangle_points, int(corner / 3u)));
  const float a = facing_of(points.x, side);
  const float b = facing_of(points.y, side);
  const float c = facing_of(points.z, side);
  const uint k = corner % 3u;
  return (k == 0u ? a : k == 1u ? b : c) / (a + b + c);
}

/// Snow at a smooth point under open sky: thickness on the positive side (x) and the back (y) of its triangles, relative to the
/// thickness perpendicular to the fall, 0 to 3; the upward part of the normal (z).
vec4 smooth_point(int point) {
  const int end = int(texelFetch(point_begin, point + 1).x);
  vec2 snow = vec2(0.0f);
  vec2 covered = vec2(0.0f);
  for (int i = int(texelFetch(point_begin, point).x); i < end; ++i) {
    const uint corner = texelFetch(point_corners, i).x;
    const vec4 surface = vec4(texelFetch(triangle_surface, int(corner / 3u)));
    if (surface_facing(surface) > 0.0f) {
      const bool back = shows_back(surface);
      const float area = surface_area(surface);
      const float own_snow = 3.0f * corner_share(corner, back ? -1.0f : 1.0f) * surface_facing(surface) * area;
      const float own_area = facing_part(surface_facing(surface)) * area;
      snow += back ? vec2(0.0f, own_snow) : vec2(own_snow, 0.0f);
      covered += back ? vec2(0.0f, own_area) : vec2(own_area, 0.0f);
    }
  }
  return vec4(covered.x > 0.0f ? snow.x / covered.x : 0.0f, covered.y > 0.0f ? snow.y / covered.y : 0.0f,
              texelFetch(point_normals, point).z, 0.0f);
}
