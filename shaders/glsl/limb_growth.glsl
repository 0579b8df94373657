// Growth of limbs that are drawn as four flat sides. Needs tree_view.glsl.
#include "lib/thin_limbs.h"

/// Metres by which the surface moves outwards so that the limb is, in the mean, as wide as if it were round.
float square_growth(float circumference, float away) {
  if (view.thesis.w > 0.5 || view.tessellation.w == 0.0) {
    return 0.0;
  }
  const float width = circumference / 3.1415927;
  const float share = round_share(width * view.eye.w / away, view.tessellation.z);
  return 0.5 * width * kSquareGrowth * (1.0 - share);
}
