#pragma once

// What a point of a surface sees of the sky: the part of the pixels around it that do not show anything in
// front of it. A pixel's depth is held against the plane through the point, so that an open plane is seen as a
// whole at any slope and with pixels of any size, and so is what lies in front of all that the pixels show: a
// twig that slips through between their centres.
#include "projection_frame.h"
#include "kernel.h"
#include "tile_pixel.h"

/// A SeenPixel each.
KERNEL_VIEW_RG32UI(occlusion);
/// See TriangleSetup.
KERNEL_VIEW_RGBA32F(triangle_corners);
/// Per triangle of the scene: the sheet it belongs to, see native/snow/texels/sheets.h.
KERNEL_VIEW_R32UI(triangle_sheets);
/// Of the tile with its margin.
KERNEL_UNIFORM(ivec2, tile_origin);

/// By how much two depths of one surface may differ by rounding: in pixels, in pixels that the rasteriser
/// snaps corners to, and as part of the scene's whole depth.
KERNEL_CONSTANT float kHairPixels = 0.01f;
KERNEL_CONSTANT float kHairSnap = 1.0f / 256.0f;
KERNEL_CONSTANT float kHairRange = 4e-7f;

/// How far the surface that a point lies on may rise over the point's plane within a pixel before it shades
/// the point: metres over the plane for each pixel of width; and how far its plane there may pass over the
/// point. Wide enough for creases and rough scans, narrow enough for a twig over its own trunk: with these
/// volumes are within 0.2 % of what rays reach on scans, animals and trees with pixels of up to three texels.
KERNEL_CONSTANT float kBend = 0.75f;
KERNEL_CONSTANT float kOverPoint = 0.3f;
/// Surfaces steeper than this are reckoned with as if they were not.
KERNEL_CONSTANT float kSteepFacing = 0.25f;

/// A point on a plane over the grid.
struct PlanePoint {
  /// Local pixel, and depth along the fall in metres.
  vec3 at;
  /// Depth that the plane gains in one pixel along each axis.
  vec2 gradient;
  /// See depth_bias_of.
  float depth_bias;
  /// Depth of a pixel's width at right angles to the plane, in metres.
  float pixel_depth;
  /// On a two-sided surface kBackFace, and that again where the side that faces the sky is its back; else 0.
  uint side_bit;
  uint side;
  /// The triangle that it lies on.
  uint triangle;
};

/// Metres of depth in which a surface cannot be told from itself.
float depth_bias_of(vec2 gradient) {
  return kHairPixels * pixel_size(projection) + kHairSnap * (abs(gradient.x) + abs(gradient.y)) +
         kHairRange / one_over_depth(projection);
}

float pixel_depth_of(float facing) { return pixel_size(projection) / max(facing, kSteepFacing); }

/// Whether a pixel that shows `shown` (a SeenPixel) shows nothing in front of the point's plane, which is `plane_depth`
/// deep at the pixel's centre, `to_point` away from the point: another surface shades the point as soon as it lies
/// nearer, a cloth on a table. What lies nearer may be the point's own surface on its way: joined to it, not far over
/// the plane, and at the point itself not in front of it.
bool is_open(uvec2 shown, float plane_depth, vec2 to_point, PlanePoint point) {
  const float depth = uintBitsToFloat(shown.y);
  // All is evaluated, so that a kernel can go through many points side by side.
  const int other = max(int(shown.x & ~kBackFace) - 1, 0);
  const bool is_near = depth >= min(plane_depth, point.at.z) - point.depth_bias - kBend * point.pixel_depth;
  // What shows its other side is another layer of the sheet: the upper half of an open tube over its lower one.
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
  /// Of the tile: the lower left one.
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

/// How far the nearest of the four pixels around the point lies behind its plane, in metres. `pixel`: index of the
/// lower left one; `plane_depth`: the plane's depth at its centre.
float clearance(int pixel, float plane_depth, vec2 gradient) {
  const float depth_00 = uintBitsToFloat(texelFetch(occlusion, pixel).y);
  const float depth_10 = uintBitsToFloat(texelFetch(occlusion, pixel + 1).y);
  const float depth_01 = uintBitsToFloat(texelFetch(occlusion, pixel + tile_size.x).y);
  const float depth_11 = uintBitsToFloat(texelFetch(occlusion, pixel + tile_size.x + 1).y);
  const float lower = min(depth_00, depth_10 - gradient.x);
  const float upper = min(depth_01, depth_11 - gradient.x);
  return min(lower, upper - gradient.y) - plane_depth;
}

/// Up to where the window reaches over the right and the upper of the pixels around the point, as a part of it.
vec2 reach_of(vec2 offset, vec2 windows) { return clamp((offset - 0.5f) * windows + 0.5f, 0.0f, 1.0f); }

/// Which part of the window a pixel holds; x and y: 1 for the right and the upper ones, else 0.
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

/// Which part (0 to 1) of the snow that falls towards the point arrives: the mean over a window of pixels, at
/// most one pixel wide and high, of what is open and, by noise, gives snow. A window as large as the pixel is
/// bilinear filtering; a smaller one keeps shadows as sharp as the map can hold. The window must lie within
/// the tile and its margin. `windows`: how many windows are as wide and as high as a pixel.
float seen_part(PlanePoint point, vec2 windows) {
  const PixelWindow window = window_of(point.at, point.gradient);
  // Nearly always.
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
