#pragma once

// A texel's surface: the sum of its fragments on the current vertices.
#include "kernel.h"
#include "snow_shared.h"

/// See TriangleSetup.
KERNEL_VIEW_RGBA32F(triangle_surface);
#ifdef WITH_SHADING
/// Per triangle of the scene: the smooth points at its corners, kNowhere if it is shaded flat.
KERNEL_VIEW_RGBA32UI(triangle_points);
/// Per smooth point, see smooth_points.h.
KERNEL_VIEW_RGBA32F(smooth_points);

bool is_smooth(uint triangle) {
  return KERNEL_IS_BOUND(triangle_points) && texelFetch(triangle_points, int(triangle)).x != kNowhere;
}

/// Smooth-point data of a triangle: at its first corner, and the differences to the others.
struct SmoothTriangle {
  vec4 corner;
  vec4 edge_b;
  vec4 edge_c;
};

/// For triangles that are shaded smooth.
SmoothTriangle smooth_triangle(uint triangle) {
  const uvec4 points = uvec4(texelFetch(triangle_points, int(triangle)));
  const vec4 a = vec4(texelFetch(smooth_points, int(points.x)));
  const vec4 b = vec4(texelFetch(smooth_points, int(points.y)));
  const vec4 c = vec4(texelFetch(smooth_points, int(points.z)));
  return KERNEL_MAKE3(SmoothTriangle, a, b - a, c - a);
}
#endif

/// Interpolates between a triangle's corners by the weights of the second and third.
float between(float corner, float edge_b, float edge_c, float weight_b, float weight_c) {
  return corner + weight_b * edge_b + weight_c * edge_c;
}

/// Sums over a texel's fragments, of areas and of areas times upward parts; `upper` and `back_upper` only include parts
/// that face up.
struct FragmentSums {
  float area;
  float up;
  float upper;
  float back_up;
  float back_upper;
};

/// The sums with one more fragment. `area` in m2; `up`: upward part of the normal on it.
FragmentSums with_fragment(FragmentSums sums, float area, float up, bool two_sided) {
  const float own_up = area * up;
  const float own_back_up = two_sided ? -own_up : 0.0f;
  return KERNEL_MAKE5(FragmentSums, sums.area + area, sums.up + own_up, sums.upper + max(own_up, 0.0f),
                      sums.back_up + own_back_up, sums.back_upper + max(own_back_up, 0.0f));
}

struct TexelSurface {
  /// In m2.
  float area;
  /// Upward part of the normal, 1 on level ground, for the capacity. A texel that wraps a twig holds snow on its parts
  /// that face up; without any, the mean of its parts is past vertical.
  float up;
  /// The same of its back, from its two-sided parts; 0 without any.
  float back_up;
};

TexelSurface surface_of_sums(FragmentSums sums) {
  if (!(sums.area > 0.0f)) {
    return KERNEL_MAKE3(TexelSurface, sums.area, 0.0f, 0.0f);
  }
  return KERNEL_MAKE3(TexelSurface, sums.area, (sums.upper > 0.0f ? sums.upper : sums.up) / sums.area,
                      (sums.back_upper > 0.0f ? sums.back_upper : sums.back_up) / sums.area);
}
