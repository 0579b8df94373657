#pragma once

// A corner of a leaf, for C++ and GLSL.
#include "shared_types.h"

#ifndef SNOWBOUGH_GLSL
namespace snowbough::shared {
#endif

struct LeafVertex {
  /// w: bits of the bone's index.
  vec4 position;
  /// Unit; w: u of the image.
  vec4 normal;
  /// v of the image; the rest is unused.
  vec4 uv_end;
};
SNOWBOUGH_SHARED_SIZE(LeafVertex, 48)

#ifndef SNOWBOUGH_GLSL
}  // namespace snowbough::shared
#endif
