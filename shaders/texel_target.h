#pragma once

// Which pixel a texel takes its snow from. Both formulations of the deposit include it.
#include "fall_frame.h"
#include "kernel.h"
#include "packed_pixel.h"
#include "texel_parts.h"
#include "tile_pixel.h"
#include "triangle_object.h"

KERNEL_VIEW_RGBA32UI(texels);
/// See triangle_fall.h.
KERNEL_VIEW_RGBA32F(triangle_corners);
/// The same, number by number.
KERNEL_VIEW_R32F(corner_words);
/// Per work group of texels: its object's slot.
KERNEL_VIEW_R32UI(group_slots);
/// A SeenPixel each.
KERNEL_VIEW_RG32UI(occlusion);
KERNEL_UNIFORM(ivec2, tile_origin);

/// How far a texel's point may lie from what its pixel shows, in pixels over the shallower slope. Beyond
/// the two planes: what lies between them may be rougher than they are, and more so round an edge.
KERNEL_CONSTANT float kSlack = 0.25f;
KERNEL_CONSTANT float kSlackRoundEdge = 0.5f;
/// Between the two planes: a wall's own slope would let it reach far below an edge.
KERNEL_CONSTANT float kMostBend = 1.0f;
KERNEL_CONSTANT float kLeastFacing = 1e-4f;

/// A triangle's plane over the grid: depth that it gains in one pixel along each axis, and its facing.
struct Plane {
  vec2 gradient;
  float facing;
};

/// A texel's triangle: its first corner and edges, in pixels and metres of depth, and its plane.
struct TexelTriangle {
  vec3 corner;
  vec3 edge_b;
  vec3 edge_c;
  Plane plane;
};

/// What a pixel shows.
struct ShownTriangle {
  Plane plane;
  /// See object_of.
  uint object;
};

KERNEL_MEMORY(TexelTriangle, last_own)
KERNEL_MEMORY(ShownTriangle, last_shown)

TexelTriangle texel_triangle(int triangle) {
  const vec4 a = texelFetch(triangle_corners, 3 * triangle);
  const vec4 b = texelFetch(triangle_corners, 3 * triangle + 1);
  const vec4 c = texelFetch(triangle_corners, 3 * triangle + 2);
  const Plane plane = KERNEL_MAKE2(Plane, vec2(a.w, b.w), c.w);
  return KERNEL_MAKE4(TexelTriangle, vec3(a), vec3(b) - vec3(a), vec3(c) - vec3(a), plane);
}

ShownTriangle shown_triangle(uint triangle) {
  const int first = 12 * int(triangle);
  const vec2 gradient =
      vec2(texelFetch(corner_words, first + 3).x, texelFetch(corner_words, first + 7).x);
  const Plane plane = KERNEL_MAKE2(Plane, gradient, texelFetch(corner_words, first + 11).x);
  return KERNEL_MAKE2(ShownTriangle, plane, object_of(triangle));
}

/// Whether a texel's point, `offset` pixels from the centre of a pixel, lies on what the pixel shows at
/// depth `shown_depth`: on the shown plane extended to the point, on the texel's own plane extended from
/// what is shown, or between them, where the surface bends between the centre and the point. What lies
/// below another surface with the same slopes lies below both planes.
bool is_shown(vec2 offset, float depth, Plane own, float shown_depth, Plane shown) {
  const float below = depth - shown_depth - dot(shown.gradient, offset);
  const float unit = fall.direction.w / max(max(own.facing, shown.facing), kLeastFacing);
  const bool faces = own.facing > 0.0f;
  const float bend =
      faces ? clamp(dot(own.gradient - shown.gradient, offset), -kMostBend * unit, kMostBend * unit) : 0.0f;
  const float slack = (faces ? kSlack : kSlackRoundEdge) * unit;
  return below >= min(bend, 0.0f) - slack && below <= max(bend, 0.0f) + slack;
}

/// The object of a texel, with kReceives.
uint texel_object(int index) { return texelFetch(group_slots, index / int(kTexelGroup)).x | kReceives; }

/// The pixel that the texel's sample point projects to, if it takes part there: the pixel shows its map
/// and its place on the surface, and some of it faces the fall. `object`: see texel_object.
TexelStep step_of(int index, uint object) {
  const TexelParts parts = parts_of(index);
  const TexelStep none = KERNEL_MAKE4(TexelStep, 0u, 0u, parts.area, parts.up);
  const uvec4 texel = texelFetch(texels, index);
  KERNEL_CONST_REF(TexelTriangle) own = KERNEL_KEPT(last_own, uvec2(texel.x, 0u), texel_triangle(int(texel.x)));
  // Where its point faces away, the texel may reach round an edge into the fall.
  const float area = own.plane.facing > 0.0f ? parts.area * own.plane.facing : parts.facing_area;
  const float weight = area / (fall.direction.w * fall.direction.w) * float(kPixelWeight);
  // A texel of hundreds of pixels is met by the pixels' centres as well as can be.
  if (weight < 0.5f || weight >= 256.0f * float(kPixelWeight)) {
    return none;
  }
  const vec3 point =
      own.corner + uintBitsToFloat(texel.z) * own.edge_b + uintBitsToFloat(texel.w) * own.edge_c;
  const vec2 corner = floor(vec2(point));
  const ivec2 pixel = ivec2(corner) - tile_origin;
  if (any(lessThan(pixel, ivec2(0))) || any(greaterThanEqual(pixel, tile_size))) {
    return none;
  }
  const uvec2 seen = uvec2(texelFetch(occlusion, pixel_index(pixel)));
  if (seen.x == 0u || (seen.x & kBackFace) != 0u) {
    return none;
  }
  KERNEL_CONST_REF(ShownTriangle) shown = KERNEL_KEPT(last_shown, uvec2(seen.x, 0u), shown_triangle(seen.x - 1u));
  if (shown.object != object ||
      !is_shown(vec2(point) - corner - 0.5f, point.z, own.plane, uintBitsToFloat(seen.y), shown.plane)) {
    return none;
  }
  return KERNEL_MAKE4(TexelStep, packed_pixel(pixel), uint(weight + 0.5f), parts.area, parts.up);
}
