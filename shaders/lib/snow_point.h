#pragma once

// The constants of a point of the snow's surface, from its place and from how thick that is which carries it.
#include "snow_noise.h"
#include "snow_surface.h"

#ifndef SNOWBOUGH_GLSL
namespace snowbough::shared {
#endif

/// Part of the thickness below a point that bare places may sink into.
KERNEL_CONSTANT float kSinkPart = 0.45f;
/// What is thicker than the first part of the depth is wide, what is thinner than the second narrow.
KERNEL_CONSTANT float kWide = 0.8f;
KERNEL_CONSTANT float kNarrow = 0.3f;

/// The noise of a point, without its bumps. `place`: in parts of the depth at the shot's end, so that noise is the same
/// at any scale.
SNOWBOUGH_SHARED_FUNCTION SnowPoint point_noise(vec3 place) {
  SnowPoint point;
  point.patches = layered_noise(place + 50.0f, vec3(2.2f, 1.0f, 0.45f), 0.8f);
  point.hem = layered_noise(place, vec3(3.0f, 1.5f, 0.6f), 0.7f);
  point.relief = layered_noise(place + 21.0f, vec3(4.0f, 1.7f, 0.8f), 0.65f);
  point.bumps = 0.0f;
  point.deepest = 1e9f;
  point.convexity = 0.0f;
  point.narrow = 0.0f;
  return point;
}

/// Noise of bumps; `place`: of the shown surface, as above.
SNOWBOUGH_SHARED_FUNCTION float bump_noise(vec3 place) {
  return layered_noise(place + 70.0f, vec3(1.1f, 0.5f, 0.0f), 0.6f);
}

/// The same point on something that is `thickness` thick, under snow that is `depth` deep at the shot's end. Metres.
SNOWBOUGH_SHARED_FUNCTION SnowPoint on_carrier(KERNEL_CONST_REF(SnowPoint) point, float thickness, float depth) {
  SnowPoint made = point;
  made.deepest = max(kSinkPart * thickness, 1e-5f);
  made.narrow = eased(thickness, kWide * depth, kNarrow * depth);
  return made;
}

/// The same point on a round limb of that width in metres; 0: as if the limb were flat, and so thin that most shows.
SNOWBOUGH_SHARED_FUNCTION SnowPoint on_limb(KERNEL_CONST_REF(SnowPoint) point, float width, float depth) {
  SnowPoint made = on_carrier(point, width, depth);
  made.convexity = width > 0.0f ? 2.0f / width : 0.0f;
  return made;
}

/// Height of the snow that shows on a limb, 0 where none does.
SNOWBOUGH_SHARED_FUNCTION float limb_height(KERNEL_CONST_REF(SnowPoint) point, KERNEL_CONST_REF(SnowStyle) style,
                                            KERNEL_CONST_REF(SnowEdge) edge, float thickness, float open_depth) {
  const float height = max(thin_snow(edge, thickness), 0.0f);
  return swept_height(point, height + surface_relief(point, style, height, open_depth));
}

/// How far from its carrier a point away from rims may be at most, under a map that holds `thickness` at most and in
/// the usual style.
SNOWBOUGH_SHARED_FUNCTION float farthest_offset(float thickness) {
  const float height = (1.0f + kMostRelief) * most_shown(thickness);
  return thickness > 0.0f ? height * length(vec3(1.0f, kMostSag, 0.0f)) : 0.0f;
}

#ifndef SNOWBOUGH_GLSL
}  // namespace snowbough::shared
#endif
