#pragma once

// A texel's surface, as the sum of its parts on the current vertices.
#include "kernel.h"
#include "snow_shared.h"

KERNEL_VIEW_RGBA32F(triangle_surface);
KERNEL_VIEW_R32UI(fragment_begin);
/// Triangle, and bits of the share.
KERNEL_VIEW_RG32UI(fragments);

struct TexelParts {
  /// In m2.
  float area;
  /// Of the parts that face the fall: area perpendicular to it, in m2.
  float facing_area;
  /// Upward part of the normal, 1 on level ground, for the capacity. A texel that goes round a twig holds
  /// snow by those of its parts that face up; one without any is past vertical by the mean of its parts.
  float up;
};

KERNEL_MEMORY(TexelParts, last_parts)

TexelParts sum_of_parts(int i, int end) {
  TexelParts sum = KERNEL_MAKE3(TexelParts, 0.0f, 0.0f, 0.0f);
  float upper = 0.0f;
  // The end is asked for at the end: llvmpipe runs a loop's body once more for a test at its head.
  do {
    const uvec2 fragment = uvec2(texelFetch(fragments, i));
    const vec4 surface = texelFetch(triangle_surface, int(fragment.x));
    const float own = i < end ? uintBitsToFloat(fragment.y) * surface.y : 0.0f;
    sum.area += own;
    sum.facing_area += own * max(surface.x, 0.0f);
    sum.up += own * surface.z;
    upper += own * max(surface.z, 0.0f);
  } while (++i < end);
  sum.up = sum.area > 0.0f ? (upper > 0.0f ? upper : sum.up) / sum.area : 0.0f;
  return sum;
}

TexelParts parts_of(int index) {
  const int begin = int(texelFetch(fragment_begin, index).x);
  const int end = int(texelFetch(fragment_begin, index + 1).x);
#ifndef SNOWBOUGH_GLSL
  // Texels that lie in one triangle as wholes are alike.
  if (begin + 1 == end) {
    const uvec2 fragment = texelFetch(fragments, begin);
    return KERNEL_KEPT(last_parts, fragment, sum_of_parts(begin, end));
  }
#endif
  return sum_of_parts(begin, end);
}
