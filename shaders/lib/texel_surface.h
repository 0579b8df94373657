#pragma once

// A texel's surface, as the sum of its fragments on the current vertices.
#include "kernel.h"
#include "snow_shared.h"

/// See TriangleSetup.
KERNEL_VIEW_RGBA32F(triangle_surface);
KERNEL_VIEW_R32UI(fragment_begin);
/// A Fragment each.
KERNEL_VIEW_RGBA32UI(fragments);

struct TexelSurface {
  /// In m2.
  float area;
  /// Upward part of the normal, 1 on level ground, for the capacity. A texel that goes round a twig holds
  /// snow by those of its parts that face up; one without any is past vertical by the mean of its parts.
  float up;
};

KERNEL_MEMO(TexelSurface, last_surface)

TexelSurface sum_of_fragments(int i, int end) {
  TexelSurface sum = KERNEL_MAKE2(TexelSurface, 0.0f, 0.0f);
  float upper = 0.0f;
  // The test stands at the end for software renderers' sake (CONTRIBUTING.md).
  do {
    const uvec4 fragment = uvec4(texelFetch(fragments, i));
    const vec4 surface = texelFetch(triangle_surface, int(fragment.x));
    const float own = i < end ? uintBitsToFloat(fragment.y) * surface.y : 0.0f;
    sum.area += own;
    sum.up += own * surface.z;
    upper += own * max(surface.z, 0.0f);
  } while (++i < end);
  sum.up = sum.area > 0.0f ? (upper > 0.0f ? upper : sum.up) / sum.area : 0.0f;
  return sum;
}

/// Of the texel whose fragments are [begin, end).
TexelSurface surface_of(int begin, int end) {
#ifndef SNOWBOUGH_GLSL
  // Texels that lie in one triangle as wholes are alike.
  if (begin + 1 == end) {
    const uvec4 fragment = texelFetch(fragments, begin);
    return KERNEL_MEMOIZED(last_surface, uvec2(fragment.x, fragment.y), sum_of_fragments(begin, end));
  }
#endif
  return sum_of_fragments(begin, end);
}
