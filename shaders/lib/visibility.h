#pragma once

// Visibility of the sky from a point of a surface: the part of the pixels around it that show nothing in front of it. A
// pixel's depth is compared with the plane through the point, so that an open plane is fully visible at any slope and
// pixel size, and so is geometry in front of everything that the pixels show: a twig that falls between pixel centres.
#include "projection_frame.h"
#include "kernel.h"
#include "tile_pixel.h"

/// A SeenPixel each.
KERNEL_VIEW_RG32UI(occlusion);
/// See TriangleSetup.
KERNEL_VIEW_RGBA32F(triangle_corners);
/// Per triangle of the scene: its sheet, see native/snow/texels/sheets.h.
KERNEL_VIEW_R32UI(triangle_sheets);
/// Of the tile with its margin.
KERNEL_UNIFORM(ivec2, tile_origin);

/// Rounding error of a depth: in pixels, in pixels of the rasteriser's snapping of corners, and relative to the scene's
/// whole depth.
KERNEL_CONSTANT float kBiasPixels = 0.01f;
KERNEL_CONSTANT float kBiasSnap = 1.0f / 256.0f;
KERNEL_CONSTANT float kBiasRange = 4e-7f;

/// Tolerances of self-shadowing: how far the point's own surface may rise over its plane, in metres per metre of pixel
/// width, before it shades the point; and how far the surface's plane may pass above the point. Large enough for
/// creases and rough scans, small enough for a twig over its own trunk: volumes are within 0.2 % of ray tracing on
/// scans, animals and trees with pixels of up to three texels.
KERNEL_CONSTANT float kBend = 0.75f;
KERNEL_CONSTANT float kOverPoint = 0.3f;
/// Cosines below this value are clamped to it.
KERNEL_CONSTANT float kSteepFacing = 0.25f;

/// A point on a plane above the grid.
struct PlanePoint {
  /// Local pixel, and depth along the fall in metres.
  vec3 at;
  /// Depth change of the plane per pixel along each axis.
  vec2 gradient;
  /// See depth_bias_of.
  float depth_bias;
  /// Depth of a pixel's width perpendicular to the plane, in metres.
  float pixel_depth;
  /// On a two-sided surface kBackFace, and the same if its back faces the sky; else 0.
  uint side_bit;
  uint side;
  /// The point's triangle.
  uint triangle;
};

/// Self-shadowing depth bias, in metres.
float depth_bias_of(vec2 gradient) {
  return kBiasPixels * pixel_size(projection) + kBiasSnap * (abs(gradient.x) + abs(gradient.y)) +
         kBiasRange / one_over_depth(projection);
}

float pixel_depth_of(float facing) { return pixel_size(projection) / max(facing, kSteepFacing); }

/// Whether a pixel that shows `shown` (a SeenPixel) shows nothing in front of the point's plane, whose depth at the
/// pixel's centre is `plane_depth`; `to_point`: offset to the point. Another surface shades the point as soon as it is
/// nearer, such as a cloth on a table. A nearer surface may be the point's own: of the same sheet and side, not far
/// above the plane, and not in front of the point itself.
bool is_open(uvec2 shown, float plane_depth, vec2 to_point, PlanePoint point) {
  const float depth = uintBitsToFloat(shown.y);
  // No early returns, so that a kernel can be vectorised over many points.
  const int other = max(int(shown.x & ~kBackFace) - 1, 0);
  const bool is_near = depth >= min(plane_depth, point.at.z) - point.depth_bias - kBend * point.pixel_depth;
  // The other side of the sheet is another layer: the upper half of an open tube above its lower half.
  const bool is_same_side = (shown.x & point.side_bit) == point.side;
  const bool is_joined =
      texelFetch(triangle_sheets, other).x == texelFetch(triangle_sheets, int(point.triangle)).x;
  const float at_point = depth + (texelFetch(triangle_corners, 3 * other).w * to_point.x +
                                  texelFetch(triangle_corners, 3 * other + 1).w * to_point.y);
  const bool is_beside = at_point >= point.at.z - point.depth_bias - kOverPoint * point.pixel_depth;
  const bool is_own_surface = is_near && is_same_side && is_joined && is_beside;
  return (is_own_surface ? kOpenSky : depth) >= plane_depth - point.depth_bias;
}

/// The four pixels around a point.
struct PixelWindow {
  /// The lower left one, in the tile.
  ivec2 pixel;
  /// From its centre to the point, 0 to 1.
  vec2 offset;
  /// Depth of the point's plane at its centre.
  float plane_depth;
};

/// `at`: local pixel and depth; `gradient`: of the plane through it.
PixelWindow window_of(vec3 at, vec2 gradient) {
  const vec2 lower = floor(vec2(at) - 0.5f);
  const vec2 offset = vec2(at) - 0.5f - lower;
  return KERNEL_MAKE3(PixelWindow, ivec2(lower) - tile_origin, offset, at.z - dot(gradient, offset));
}

/// Distance in metres by which the nearest of the four pixels around the point is behind its plane. `pixel`: index of
/// the lower left one; `plane_depth`: the plane's depth at its centre.
float clearance(int pixel, float plane_depth, vec2 gradient) {
  const float depth_00 = uintBitsToFloat(texelFetch(occlusion, pixel).y);
  const float depth_10 = uintBitsToFloat(texelFetch(occlusion, pixel + 1).y);
  const float depth_01 = uintBitsToFloat(texelFetch(occlusion, pixel + tile_size.x).y);
  const float depth_11 = uintBitsToFloat(texelFetch(occlusion, pixel + tile_size.x + 1).y);
  const float lower = min(depth_00, depth_10 - gradient.x);
  const float upper = min(depth_01, depth_11 - gradient.x);
  return min(lower, upper - gradient.y) - plane_depth;
}

/// The fraction of the window that lies in the right and upper pixels around the point.
vec2 reach_of(vec2 offset, vec2 windows) { return clamp((offset - 0.5f) * windows + 0.5f, 0.0f, 1.0f); }

/// The fraction of the window in a pixel; x and y: 1 for the right and the upper ones, else 0.
float window_part(vec2 reach, int x, int y) {
  return (x == 0 ? 1.0f - reach.x : reach.x) * (y == 0 ? 1.0f - reach.y : reach.y);
}

/// Whether the window's pixel (x, y) is open.
bool is_open_in(PixelWindow window, int x, int y, PlanePoint point) {
  const ivec2 pixel = window.pixel + ivec2(x, y);
  const vec2 to_point = vec2(point.at) - vec2(pixel + tile_origin) - 0.5f;
  const float plane_depth = window.plane_depth + float(x) * point.gradient.x + float(y) * point.gradient.y;
  return is_open(uvec2(texelFetch(occlusion, pixel_index(pixel))), plane_depth, to_point, point);
}

/// The fraction (0 to 1) of the falling snow that arrives at the point: the mean, over a window of pixels at most one
/// pixel wide and high, of the pixels that are open and, by noise, give snow. A window of one pixel is bilinear
/// filtering; a smaller one keeps shadows as sharp as the map allows. The window must lie within the tile and its
/// margin. `windows`: number of windows in a pixel's width and height.
float seen_part(PlanePoint point, vec2 windows) {
  const PixelWindow window = window_of(point.at, point.gradient);
  // The usual case.
  if (noise_density(projection) >= 1.0f &&
      clearance(pixel_index(window.pixel), window.plane_depth, point.gradient) >= -point.depth_bias) {
    return 1.0f;
  }
  const vec2 reach = reach_of(window.offset, windows);
  float seen = 0.0f;
  for (int i = 0; i < 4; ++i) {
    const int x = i & 1;
    const int y = i >> 1;
    const float part = window_part(reach, x, y);
    if (part > 0.0f && gives_snow(window.pixel + ivec2(x, y) + tile_origin) && is_open_in(window, x, y, point)) {
      seen += part;
    }
  }
  return seen;
}
