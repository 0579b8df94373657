// Growth of limbs that are drawn as four flat sides. Needs tree_view.glsl.
//
// SNOW: of a tree with snow.
#include "lib/thin_limbs.h"

/// Metres by which the surface moves outwards so that the limb is, in the mean, as wide as if it were round.
float square_growth(float circumference, float away) {
  if (view.thesis.w > 0.5 || view.tessellation.w == 0.0) {
    return 0.0;
  }
  const float width = circumference / 3.1415927;
  const float pixels = view.eye.w / away;
#ifdef SNOW
  const float share = snowy_round_share(width * pixels, view.snow.y * pixels, view.tessellation.z);
#else
  const float share = round_share(width * pixels, view.tessellation.z);
#endif
  return 0.5 * width * kSquareGrowth * (1.0 - share);
}
