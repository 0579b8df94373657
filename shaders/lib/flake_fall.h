#pragma once

// Positions of falling flakes: a lattice of cells that the fall carries through a box around the eye, which depends
// only on seed and time.
#include "shared_types.h"
#ifndef SNOWBOUGH_GLSL
namespace snowbough::shared {
#endif

/// Parameters of a draw of flakes, in a uniform block.
struct FlakeFall {
  /// Distance fallen so far, wrapped to the box; w: edge of the box. All lengths are in scene units.
  vec4 drift;
  /// Distance per second; w: radius of a flake.
  vec4 velocity;
  /// Sideways amplitude of the flutter, its frequency in Hz, shutter time in seconds, time in seconds.
  vec4 flutter;
  /// Seed and number of flakes; z, w: unused.
  uvec4 counts;
  /// x: length of a metre.
  vec4 scale;
};
SNOWBOUGH_SHARED_SIZE(FlakeFall, 80)

#ifndef SNOWBOUGH_GLSL
}  // namespace snowbough::shared
#endif
