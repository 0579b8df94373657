// GLSL only: snow that is laid on texels in integers, so that the order does not matter.
#include "snow_shared.h"

/// Thickness in units of step depth / kDepthUnits, saturating.
layout(std430) buffer DepositUnits { uint deposit_units[]; };
uniform float step_depth;

/// `thickness` in metres.
void add_to_texel(int texel, float thickness) {
  const uint units = uint(min(thickness / step_depth * kDepthUnits + 0.5, 4294967040.0));
  const uint before = atomicAdd(deposit_units[texel], units);
  if (before > kNowhere - units) {
    // Whoever runs it over sets it full again, so that it ends full, in whatever order they come.
    atomicOr(deposit_units[texel], kNowhere);
  }
}
