// Growth of limbs that are drawn as four flat sides. Needs tree_view.glsl.
//
// SNOW: also of trees with snow.
#include "glsl/tree_instance.glsl"
#include "lib/thin_limbs.h"

/// Metres by which the surface moves outwards so that the limb is, in the mean, as wide as if it were round.
float square_growth(float circumference, float away) {
  if (view.thesis.w > 0.5 || view.tessellation.w == 0.0) {
    return 0.0;
  }
  const float width = circumference / 3.1415927;
  const float pixels = view.eye.w / away;
  float share = round_share(width * pixels, view.tessellation.z);
#ifdef SNOW
  if (has_snow()) {
    share = snowy_round_share(width * pixels, tree.snow.x * pixels, view.tessellation.z);
  }
#endif
  return 0.5 * width * kSquareGrowth * (1.0 - share);
}
