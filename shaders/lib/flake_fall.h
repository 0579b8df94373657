#pragma once

// Where falling flakes are: a lattice of cells that the fall carries through a box around the eye, the same for the
// same seed and time wherever the camera is.
#include "shared_types.h"
#ifndef SNOWBOUGH_GLSL
namespace snowbough::shared {
#endif

/// What falls, as a picture's draw of flakes is told; lies in a uniform block.
struct FlakeFall {
  /// How far the fall has come by now, wrapped to the box; w: edge of the box. All lengths are in the scene's units.
  vec4 drift;
  /// A second's way; w: radius of a flake.
  vec4 velocity;
  /// How far flutter takes a flake aside, swings a second, seconds that the shutter is open, time in seconds.
  vec4 flutter;
  /// Seed and number of flakes; z, w: unused.
  uvec4 counts;
  /// x: a metre.
  vec4 scale;
};
SNOWBOUGH_SHARED_SIZE(FlakeFall, 80)

#ifndef SNOWBOUGH_GLSL
}  // namespace snowbough::shared
#endif
