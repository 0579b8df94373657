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
  /// Middle of the leaf; w: v of the image.
  vec4 middle;
  /// Distance of the leaf's farthest corner from its middle (m), and the leaf's number, see lib/thin_limbs.h.
  vec4 leaf;
};
SNOWBOUGH_SHARED_SIZE(LeafVertex, 64)

#ifndef SNOWBOUGH_GLSL
}  // namespace snowbough::shared
#endif
