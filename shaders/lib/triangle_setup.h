#pragma once

// A triangle as seen along a step's fall, from its vertices. For C++ and GLSL.
#include "snow_shared.h"
#include "shared_functions.h"

#ifndef SNOWBOUGH_GLSL
namespace snowbough::shared {
#endif

/// The data of a triangle for the passes of a step.
struct TriangleSetup {
  /// xyz: local pixel and depth in metres along the fall. w of the first two: depth change of the plane per pixel along
  /// the grid's axes; w of the third: facing.
  vec4 corner_a;
  vec4 corner_b;
  vec4 corner_c;
  /// x: cosine between the normal and the direction to the sky ("facing"; for a two-sided triangle of the side that
  /// faces the sky), y: area in m2, z: upward part of the normal, w: for a two-sided triangle the side that
  /// faces the sky, 1 = positive, -1 = back; else 0. All are 0 for a triangle without area. Read with the functions of
  /// facing.h.
  vec4 surface;
};
SNOWBOUGH_SHARED_SIZE(TriangleSetup, 64)

/// Lower clamp of the cosine: slopes of nearly edge-on faces are too steep to compute.
KERNEL_CONSTANT float kMinFacing = 1e-4f;

/// Local pixel coordinates (xy) and depth along the fall in metres (z).
SNOWBOUGH_SHARED_FUNCTION vec3 projected(vec3 position, KERNEL_CONST_REF(ProjectionFrame) frame) {
  const vec3 offset = position - vec3(frame.anchor);
  const vec2 pixel = anchor_pixel(frame);
  return vec3(dot(offset, vec3(frame.grid_x)) + pixel.x, dot(offset, vec3(frame.grid_y)) + pixel.y,
              dot(offset, vec3(frame.direction)));
}

/// The triangle a, b, c, corners in metres. `two_sided`: its back gathers snow, too.
SNOWBOUGH_SHARED_FUNCTION TriangleSetup set_up_triangle(vec3 a, vec3 b, vec3 c, bool two_sided,
                                                        KERNEL_CONST_REF(ProjectionFrame) frame) {
  const vec3 ab = b - a;
  const vec3 ac = c - a;
  // Scaled before the product: the square of a micrometre's area underflows.
  const float scale = max(max(abs(ab.x), max(abs(ab.y), abs(ab.z))),
                          max(abs(ac.x), max(abs(ac.y), abs(ac.z))));
  vec3 normal = scale > 0.0f ? cross(ab / scale, ac / scale) : vec3(0.0f);
  const float size = length(normal);
  normal = size > 0.0f ? normal / size : vec3(0.0f);
  const float up = normal.z;
  float side = two_sided && size > 0.0f ? 1.0f : 0.0f;
  if (two_sided && dot(normal, vec3(frame.direction)) > 0.0f) {
    normal = -normal;
    side = -side;
  }
  const float facing = -dot(normal, vec3(frame.direction));
  const float metres_a_pixel = pixel_size(frame);
  const vec2 gradient = vec2(dot(normal, vec3(frame.grid_x)), dot(normal, vec3(frame.grid_y))) *
                        (metres_a_pixel * metres_a_pixel / max(facing, kMinFacing));
  return KERNEL_MAKE4(TriangleSetup, vec4(projected(a, frame), gradient.x),
                      vec4(projected(b, frame), gradient.y), vec4(projected(c, frame), facing),
                      vec4(facing, 0.5f * size * scale * scale, up, side));
}

#ifndef SNOWBOUGH_GLSL
}  // namespace snowbough::shared
#endif
