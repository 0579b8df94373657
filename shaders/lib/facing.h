#pragma once

// What a triangle's surface holds (TriangleSetup::surface), and which ones the fall may meet. For C++ and GLSL.
#include "shared_functions.h"

#ifndef SNOWBOUGH_GLSL
namespace snowbough::shared {
#endif

/// Cosine between the normal of the side that gathers and the way to the sky.
SNOWBOUGH_SHARED_FUNCTION float surface_facing(vec4 surface) { return surface.x; }
/// In m2.
SNOWBOUGH_SHARED_FUNCTION float surface_area(vec4 surface) { return surface.y; }
/// Upward part of the front's normal.
SNOWBOUGH_SHARED_FUNCTION float surface_up(vec4 surface) { return surface.z; }
/// Of a two-sided triangle the side that faces the sky, 1: front, -1: back; else 0.
SNOWBOUGH_SHARED_FUNCTION float surface_side(vec4 surface) { return surface.w; }
SNOWBOUGH_SHARED_FUNCTION bool shows_back(vec4 surface) { return surface_side(surface) < 0.0f; }

/// Faces that are edge-on but for rounding may take snow.
KERNEL_CONSTANT float kEdgeOn = 1e-5f;

/// `facing`: cosine between the triangle's normal and the way to the sky.
SNOWBOUGH_SHARED_FUNCTION bool may_face_the_fall(float facing) { return facing > -kEdgeOn; }

/// A triangle that is shaded smooth and faces the fall by less than this has less of what its smooth points hold,
/// the less it does: what is edge-on but for rounding is to count as nothing.
KERNEL_CONSTANT float kFullFacing = 0.05f;

/// Which part of what its smooth points hold a triangle has, 0 to 1.
SNOWBOUGH_SHARED_FUNCTION float front_part(float facing) {
  return clamp(facing * (1.0f / kFullFacing), 0.0f, 1.0f);
}

#ifndef SNOWBOUGH_GLSL
}  // namespace snowbough::shared
#endif
