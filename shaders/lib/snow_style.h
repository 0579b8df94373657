#pragma once

#include "shared_functions.h"

#ifndef SNOWBOUGH_GLSL
namespace snowbough::shared {
#endif

/// The artist's settings; 1 is the default look.
struct SNOWBOUGH_SHARED_ROWS SnowStyle {
  float overhang;
  float hem_variation;
  float bridging;
  float relief;
};

SNOWBOUGH_SHARED_FUNCTION SnowStyle usual_style() {
  SnowStyle style;
  style.overhang = 1.0f;
  style.hem_variation = 1.0f;
  style.bridging = 1.0f;
  style.relief = 1.0f;
  return style;
}

#ifndef SNOWBOUGH_GLSL
}  // namespace snowbough::shared
#endif
