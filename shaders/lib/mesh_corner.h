#pragma once

// A corner of a mesh that is drawn without tessellation, for C++ and GLSL.
#include "shared_types.h"

#ifndef SNOWBOUGH_GLSL
namespace snowbough::shared {
#endif

struct MeshCorner {
  /// w: u of the image.
  vec4 position;
  /// Unit; w: v of the image.
  vec4 normal;
};
SNOWBOUGH_SHARED_SIZE(MeshCorner, 32)

#ifndef SNOWBOUGH_GLSL
}  // namespace snowbough::shared
#endif
