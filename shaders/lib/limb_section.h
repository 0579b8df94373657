#pragma once

// Projection of points of the four-sided base onto the limbs' round surface: the nearest point on a section's infinite line
// plus the radius along the offset (D. T. Reynolds, PhD thesis, University of East Anglia, 2014, eq. 3.4.2).
#include "shared_functions.h"
#include "tree_shared.h"

#ifndef SNOWBOUGH_GLSL
namespace snowbough::shared {
#endif

/// A section's radius beside p (metres).
SNOWBOUGH_SHARED_FUNCTION float limb_radius(KERNEL_CONST_REF(TreeSection) section, vec3 p) {
  const float along = dot(p - vec3(section.begin), vec3(section.axis));
  const float t = clamp(along / section.begin.w, 0.0f, 1.0f);
  return section.radii.x + (section.radii.y - section.radii.x) * t;
}

/// Projects p onto a section's radius: the nearest point on its infinite line plus the radius along the offset. Points
/// on the line stay, and a section that starts at a hole becomes round only over its first width.
/// Source: D. T. Reynolds, PhD thesis, University of East Anglia, 2014, eq. 3.4.2.
SNOWBOUGH_SHARED_FUNCTION vec3 on_limb(KERNEL_CONST_REF(TreeSection) section, vec3 p) {
  const vec3 begin = vec3(section.begin);
  const vec3 axis = vec3(section.axis);
  const float along = dot(p - begin, axis);
  const vec3 foot = begin + axis * along;
  const vec3 off = p - foot;
  const float off_length = length(off);
  if (off_length < 1e-3f * min(section.radii.x, section.radii.y)) {
    return p;
  }
  const vec3 round_point = foot + off * (limb_radius(section, p) / off_length);
  const float share = section.axis.w > 0.5f ? clamp(along / section.radii.z, 0.0f, 1.0f) : 1.0f;
  return p + (round_point - p) * share;
}

/// Unit normal of a section's surface beside p; p must not be on the section's line.
SNOWBOUGH_SHARED_FUNCTION vec3 limb_normal(KERNEL_CONST_REF(TreeSection) section, vec3 p) {
  const vec3 axis = vec3(section.axis);
  const vec3 off = p - vec3(section.begin);
  const vec3 across = off - axis * dot(off, axis);
  const float slope = (section.radii.y - section.radii.x) / max(section.begin.w, 1e-12f);
  const vec3 normal = across * (1.0f / max(length(across), 1e-30f)) - axis * slope;
  return normal * (1.0f / length(normal));
}

/// Position across a side of a limb, 0 to 1, at which the chord is below the arc's fraction t: a quarter circle from
/// -45 to 45 degrees, so that points on the arc are evenly spaced.
SNOWBOUGH_SHARED_FUNCTION float chord_share(float t) {
  return 0.5f + 0.5f * tan((2.0f * t - 1.0f) * 0.785398163f);
}

/// Weight of the distance to a vertex at fraction t from it, 1 to 0: 0 from the middle on, where the surface is round.
SNOWBOUGH_SHARED_FUNCTION float rest_share(float t) {
  const float left = max(1.0f - 2.0f * t, 0.0f);
  return left * left;
}

#ifndef SNOWBOUGH_GLSL
}  // namespace snowbough::shared
#endif
