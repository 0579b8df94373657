#pragma once

// A triangle in a pixel of the grid: its snapped corners, its depth, and whether an alpha image cuts a hole. For C++
// and GLSL.
#include "snow_shared.h"
#include "shared_functions.h"

#ifndef SNOWBOUGH_GLSL
namespace snowbough::shared {
#endif

/// Sub-pixel steps to which corners are snapped: every tile rasterises the same triangle, independent of its origin.
KERNEL_CONSTANT float kStepsAPixel = 256.0f;

/// A triangle's depth as a plane over the grid, the same for all its pixels.
struct DepthPlane {
  /// xy: first corner in local pixels, zw: depth change of the plane per pixel along the grid's axes.
  vec4 corner_gradient;
  /// Depth at the first corner, smallest and largest depth, in metres along the fall.
  vec3 range;
  /// 1 + triangle with kBackFace, as in a SeenPixel.
  uint seen;
};

/// An alpha image on a triangle.
struct AlphaPlane {
  /// First corner in the image.
  vec2 corner;
  /// Gradient of u (xy) and of v (zw) over local pixels.
  vec4 gradient;
};

/// A corner of the triangle set-up (xyz: local pixel and depth), snapped to the grid's steps.
SNOWBOUGH_SHARED_FUNCTION vec3 snapped(vec4 corner) {
  return vec3(floor(corner.x * kStepsAPixel + 0.5f) * (1.0f / kStepsAPixel),
              floor(corner.y * kStepsAPixel + 0.5f) * (1.0f / kStepsAPixel), corner.z);
}

/// Twice the area of a triangle in pixels, negative if it faces away from the sky: the cross product of the grid's axes
/// points to the sky, so triangles that face it wind anticlockwise.
SNOWBOUGH_SHARED_FUNCTION float area_in_pixels(vec3 a, vec3 b, vec3 c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// The depth plane of triangle `index` from its snapped corners.
SNOWBOUGH_SHARED_FUNCTION DepthPlane depth_plane(vec3 a, vec3 b, vec3 c, uint index) {
  const vec3 ab = b - a;
  const vec3 ac = c - a;
  const float area = area_in_pixels(a, b, c);
  const vec2 gradient =
      area == 0.0f ? vec2(0.0f)
                   : vec2(ab.z * ac.y - ac.z * ab.y, ab.x * ac.z - ac.x * ab.z) / area;
  return KERNEL_MAKE3(DepthPlane, vec4(a.x, a.y, gradient.x, gradient.y),
                      vec3(a.z, min(a.z, min(b.z, c.z)), max(a.z, max(b.z, c.z))),
                      (index + 1u) | (area > 0.0f ? 0u : kBackFace));
}

/// Depth in metres at `offset` (local pixels) from the plane's corner, clamped to the range of the corners.
SNOWBOUGH_SHARED_FUNCTION float depth_at(float offset_x, float offset_y, vec4 corner_gradient,
                                         vec3 range) {
  return clamp(range.x + offset_x * corner_gradient.z + offset_y * corner_gradient.w, range.y,
               range.z);
}

/// The mapping of an image onto a triangle from its snapped corners.
SNOWBOUGH_SHARED_FUNCTION AlphaPlane alpha_plane(vec3 a, vec3 b, vec3 c, vec2 uv_a, vec2 uv_b,
                                                 vec2 uv_c) {
  const vec3 ab = b - a;
  const vec3 ac = c - a;
  const vec2 uv_ab = uv_b - uv_a;
  const vec2 uv_ac = uv_c - uv_a;
  const float area = area_in_pixels(a, b, c);
  const vec4 across = vec4(uv_ab.x * ac.y - uv_ac.x * ab.y, ab.x * uv_ac.x - ac.x * uv_ab.x,
                           uv_ab.y * ac.y - uv_ac.y * ab.y, ab.x * uv_ac.y - ac.x * uv_ab.y);
  return KERNEL_MAKE2(AlphaPlane, uv_a, area == 0.0f ? vec4(0.0f) : across / area);
}

/// Image coordinates of a pixel, `offset` (local pixels) from the first corner.
SNOWBOUGH_SHARED_FUNCTION vec2 alpha_uv(float offset_x, float offset_y, vec2 corner, vec4 gradient) {
  return corner + offset_x * vec2(gradient.x, gradient.z) + offset_y * vec2(gradient.y, gradient.w);
}

/// The mask bit at uv: of the texel that contains it. kNowhere: none; snow falls through.
SNOWBOUGH_SHARED_FUNCTION uint mask_bit(vec2 uv, KERNEL_CONST_REF(AlphaMaskHeader) mask) {
  if (mask.extension == kAlphaClip &&
      (min(uv.x, uv.y) < 0.0f || max(uv.x, uv.y) > 1.0f)) {
    return kNowhere;
  }
  vec2 inside = uv;
  if (mask.extension == kAlphaRepeat) {
    inside = uv - floor(uv);
  } else if (mask.extension == kAlphaMirror) {
    inside = 1.0f - abs(uv - 2.0f * floor(0.5f * uv) - 1.0f);
  }
  const ivec2 size = ivec2(int(mask.width), int(mask.height));
  const ivec2 texel =
      clamp(ivec2(clamp(inside, 0.0f, 1.0f) * vec2(size)), ivec2(0), size - 1);
  return uint(texel.y * size.x + texel.x);
}

/// Whether a mask's bit, in its word, is a hole.
SNOWBOUGH_SHARED_FUNCTION bool is_hole(uint word, uint bit) {
  return ((word >> (bit & 31u)) & 1u) == 0u;
}

#ifndef SNOWBOUGH_GLSL
}  // namespace snowbough::shared
#endif
