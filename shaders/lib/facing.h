#pragma once

// Which triangles the fall may meet. For C++ and GLSL.
#include "shared_functions.h"

#ifndef SNOWBOUGH_GLSL
namespace snowbough::shared {
#endif

/// Faces that are edge-on but for rounding may take snow.
KERNEL_CONSTANT float kEdgeOn = 1e-5f;

/// `facing`: cosine between the triangle's normal and the way to the sky.
SNOWBOUGH_SHARED_FUNCTION bool may_face_the_fall(float facing) { return facing > -kEdgeOn; }

#ifndef SNOWBOUGH_GLSL
}  // namespace snowbough::shared
#endif
