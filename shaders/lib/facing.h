#pragma once

// Fields of a triangle's surface (TriangleSetup::surface), and which triangles the fall may meet. For C++ and GLSL.
#include "shared_functions.h"

#ifndef SNOWBOUGH_GLSL
namespace snowbough::shared {
#endif

/// Cosine between the normal of the gathering side and the direction to the sky.
SNOWBOUGH_SHARED_FUNCTION float surface_facing(vec4 surface) { return surface.x; }
/// In m2.
SNOWBOUGH_SHARED_FUNCTION float surface_area(vec4 surface) { return surface.y; }
/// Upward part of the normal.
SNOWBOUGH_SHARED_FUNCTION float surface_up(vec4 surface) { return surface.z; }
/// For a two-sided triangle the side that faces the sky, 1: positive, -1: back; else 0.
SNOWBOUGH_SHARED_FUNCTION float surface_side(vec4 surface) { return surface.w; }
SNOWBOUGH_SHARED_FUNCTION bool shows_back(vec4 surface) { return surface_side(surface) < 0.0f; }

/// Faces that are edge-on up to rounding may take snow.
KERNEL_CONSTANT float kEdgeOn = 1e-5f;

/// `facing`: cosine between the triangle's normal and the direction to the sky.
SNOWBOUGH_SHARED_FUNCTION bool may_face_the_fall(float facing) { return facing > -kEdgeOn; }

/// A smooth-shaded triangle that faces the fall by less than this gets a proportional part of its smooth points' snow:
/// triangles that are edge-on up to rounding must count as nothing.
KERNEL_CONSTANT float kFullFacing = 0.05f;

/// The part of its smooth points' snow that a triangle gets, 0 to 1.
SNOWBOUGH_SHARED_FUNCTION float facing_part(float facing) {
  return clamp(facing * (1.0f / kFullFacing), 0.0f, 1.0f);
}

#ifndef SNOWBOUGH_GLSL
}  // namespace snowbough::shared
#endif
