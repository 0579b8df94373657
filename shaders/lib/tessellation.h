#pragma once

// Tessellation levels of a base edge.
#include "shared_functions.h"
#include "tree_shared.h"

#ifndef SNOWBOUGH_GLSL
namespace snowbough::shared {
#endif

/// The thesis's level Tl, from the distance of an edge (m), the area of its faces (m2) and their branch level:
/// (1 - Fd / Mtd) * (Fa / Mfa) * Mtl * (1 - level / levels), within 1 and Mtl.
/// Source: D. T. Reynolds, PhD thesis, University of East Anglia, 2014, eq. 3.4.1.
SNOWBOUGH_SHARED_FUNCTION float thesis_level(float away, float area, float branch_level, vec4 thesis,
                                             float highest) {
  const float near_share = max(1.0f - away / thesis.x, 0.0f);
  const float level_share = 1.0f - branch_level / thesis.z;
  return clamp(near_share * (area / thesis.y) * highest * level_share, 1.0f, highest);
}

/// The thesis's level tf of a face under snow, from the upward part of its normal, its area in normalised device
/// coordinates (the whole picture: 4) and the factor m: clamp(max(n . up, 0) * m * area / 4, 1, highest).
/// Source: D. T. Reynolds, PhD thesis, University of East Anglia, 2014, section 4.2.2.
SNOWBOUGH_SHARED_FUNCTION float thesis_snow_level(float up, float area, float factor, float highest) {
  return clamp(max(up, 0.0f) * factor * 0.25f * area, 1.0f, highest);
}

/// The level at which the parts of an edge cover `target` pixels: its length plus the bark's displacement (m), seen
/// perpendicular, so that it does not change as the view turns.
SNOWBOUGH_SHARED_FUNCTION float screen_level(float away, float edge_length, float bark, float pixels_at_one_metre,
                                             float target, float highest) {
  const float whole = edge_length + 2.0f * bark;
  const float pixels = whole * pixels_at_one_metre / max(away, 0.5f * whole);
  return clamp(pixels / target, 1.0f, highest);
}

/// Maximum deviation of a limb's outline from its circle, as a fraction of the target, in pixels.
const float kOutlineShare = 0.025f;

/// The level at which a quarter of a limb's circle, seen from the side, deviates from its chords by at most
/// `kOutlineShare` of the target: a chord that spans an angle 2 a deviates by radius * (1 - cos(a)). `chord`: length
/// from a quarter's beginning to its end (m), including bark and snow.
SNOWBOUGH_SHARED_FUNCTION float outline_level(float away, float chord, float pixels_at_one_metre, float target,
                                              float highest) {
  const float radius = 0.70710678f * chord;
  const float pixels = radius * pixels_at_one_metre / max(away, radius);
  const float strays = kOutlineShare * target / max(pixels, 1e-6f);
  return clamp(0.78539816f / acos(max(1.0f - strays, 0.0f)), 1.0f, highest);
}

/// Whether patches of a branch level are dropped at a distance: levels over 1 beyond
/// Mtd * levels * (1 - level / levels). Source as above.
SNOWBOUGH_SHARED_FUNCTION bool is_level_too_far(float away, float branch_level, vec4 thesis) {
  return branch_level > 1.0f && away > thesis.x * thesis.z * (1.0f - branch_level / thesis.z);
}

#ifndef SNOWBOUGH_GLSL
}  // namespace snowbough::shared
#endif
