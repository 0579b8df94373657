#pragma once

// Limbs that are too thin and leaves that are too small for the picture: some are dropped, and the others grow, so that
// the tree covers the same area. R. Cook, J. Halstead, M. Planck, D. Ryu, Stochastic Simplification of Aggregate
// Detail, 2007.
#include "shared_functions.h"

#ifndef SNOWBOUGH_GLSL
namespace snowbough::shared {
#endif

/// Width of a patch of a limb in distances of its corners from the middle line.
KERNEL_CONSTANT float kDrawnWidth = 1.4142136f;
/// Least length of a drawn section in least widths.
KERNEL_CONSTANT float kMinLength = 2.0f;
/// Least length of a drawn leaf in least widths of limbs.
KERNEL_CONSTANT float kMinLeaf = 1.5f;
/// Fraction of the drawn patches that are fading out.
KERNEL_CONSTANT float kFading = 0.25f;

/// Fraction that is drawn of patches `pixels` wide; the drawn ones grow to `least` pixels.
SNOWBOUGH_SHARED_FUNCTION float drawn_share(float pixels, float least) {
  return pixels < least ? pixels / least : 1.0f;
}

/// Growth of a square that gives it the mean width, over all directions, of the circle around it.
KERNEL_CONSTANT float kSquareGrowth = 0.1107207f;

/// Fraction of its tessellation levels that a limb gets: none if its width is less than half of `target`. Both in
/// pixels.
SNOWBOUGH_SHARED_FUNCTION float round_share(float width, float target) {
  return clamp(2.0f * width / target - 1.0f, 0.0f, 1.0f);
}

/// The same under snow of `depth` pixels on open ground, whose crest lies between the corners of the four sides: limbs
/// wider than 1/6 of `target` are tessellated if the snow is deeper than 1/12 of it.
SNOWBOUGH_SHARED_FUNCTION float snowy_round_share(float width, float depth, float target) {
  const float crest = clamp(min(6.0f * width, 12.0f * depth) / target - 1.0f, 0.0f, 1.0f);
  return max(round_share(width, target), crest);
}

/// Number from 0 to 1 of a patch: those with small numbers stay longest. Successive patches have numbers far apart.
SNOWBOUGH_SHARED_FUNCTION float patch_number(int index) {
  const float golden = 0.61803399f * float(index & 0xFFFF);
  return golden - floor(golden);
}

/// Factor of the covered area of a patch or leaf with this number; 0: dropped. `share` > 0: the fraction that
/// is drawn. The mean over all numbers is 1. They fade out before they are dropped.
SNOWBOUGH_SHARED_FUNCTION float area_factor(float share, float number) {
  const float all = share / (1.0f - kFading);
  const float fading = kFading * all;
  const float past = max(all - 1.0f, 0.0f);
  const float left = all - share;
  const float mean = min(share, 1.0f) + (left * left - past * past) / (2.0f * fading);
  return clamp((all - number) / fading, 0.0f, 1.0f) / mean;
}

#ifndef SNOWBOUGH_GLSL
}  // namespace snowbough::shared
#endif
