#pragma once

// A texel's surface, as the sum of its fragments on the current vertices.
#include "kernel.h"
#include "snow_shared.h"

/// See TriangleSetup.
KERNEL_VIEW_RGBA32F(triangle_surface);
KERNEL_VIEW_R32UI(fragment_begin);
/// A Fragment each.
KERNEL_VIEW_RGBA32UI(fragments);
#ifdef WITH_SHADING
/// Per triangle of the scene: the smooth points at its corners, kNowhere where it is shaded flat.
KERNEL_VIEW_RGBA32UI(triangle_points);
/// Per smooth point, see smooth_points.h.
KERNEL_VIEW_RGBA32F(smooth_points);

bool is_smooth(uint triangle) {
  return KERNEL_IS_BOUND(triangle_points) && texelFetch(triangle_points, int(triangle)).x != kNowhere;
}

/// What the smooth points of a triangle say at a fragment's centroid.
vec4 smooth_at(uvec4 fragment) {
  const uvec4 points = uvec4(texelFetch(triangle_points, int(fragment.x)));
  const vec4 a = vec4(texelFetch(smooth_points, int(points.x)));
  const vec4 b = vec4(texelFetch(smooth_points, int(points.y)));
  const vec4 c = vec4(texelFetch(smooth_points, int(points.z)));
  return a + uintBitsToFloat(fragment.z) * (b - a) + uintBitsToFloat(fragment.w) * (c - a);
}
#endif

struct TexelSurface {
  /// In m2.
  float area;
  /// Upward part of the normal, 1 on level ground, for the capacity. A texel that goes round a twig holds
  /// snow by those of its parts that face up; one without any is past vertical by the mean of its parts.
  float up;
  /// The same of its back, by its two-sided parts; 0 where it has none.
  float back_up;
  /// Whether parts face the fall with their front, and with their back.
  bool faces_front;
  bool faces_back;
};

KERNEL_MEMO(TexelSurface, last_surface)

/// Upward part of the front's normal on a fragment; `surface`: its triangle's.
float fragment_up(uvec4 fragment, vec4 surface) {
#ifdef WITH_SHADING
  if (is_smooth(fragment.x)) {
    return smooth_at(fragment).z;
  }
#endif
  return surface.z;
}

TexelSurface sum_of_fragments(int i, int end) {
  TexelSurface sum = KERNEL_MAKE5(TexelSurface, 0.0f, 0.0f, 0.0f, false, false);
  float upper = 0.0f;
  float back_upper = 0.0f;
  // The test stands at the end for software renderers' sake (CONTRIBUTING.md).
  do {
    const uvec4 fragment = uvec4(texelFetch(fragments, i));
    const vec4 surface = texelFetch(triangle_surface, int(fragment.x));
    const float own = i < end ? uintBitsToFloat(fragment.y) * surface.y : 0.0f;
    const float own_up = own * fragment_up(fragment, surface);
    const float own_back_up = surface.w != 0.0f ? -own_up : 0.0f;
    sum.area += own;
    sum.up += own_up;
    upper += max(own_up, 0.0f);
    sum.back_up += own_back_up;
    back_upper += max(own_back_up, 0.0f);
    const bool faces = i < end && surface.x > 0.0f;
    sum.faces_front = sum.faces_front || (faces && surface.w >= 0.0f);
    sum.faces_back = sum.faces_back || (faces && surface.w < 0.0f);
  } while (++i < end);
  sum.up = sum.area > 0.0f ? (upper > 0.0f ? upper : sum.up) / sum.area : 0.0f;
  sum.back_up = sum.area > 0.0f ? (back_upper > 0.0f ? back_upper : sum.back_up) / sum.area : 0.0f;
  return sum;
}

/// Of the texel whose fragments are [begin, end).
TexelSurface surface_of(int begin, int end) {
#ifndef SNOWBOUGH_GLSL
  // Texels that lie in one triangle as wholes are alike, unless it is shaded smooth.
  if (begin + 1 == end) {
    const uvec4 fragment = texelFetch(fragments, begin);
    if (!is_smooth(fragment.x)) {
      return KERNEL_MEMOIZED(last_surface, uvec2(fragment.x, fragment.y), sum_of_fragments(begin, end));
    }
  }
#endif
  return sum_of_fragments(begin, end);
}
