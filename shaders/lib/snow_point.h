#pragma once

// The constants of a point of the snow surface, from its position and the thickness of its carrier.
#include "snow_noise.h"
#include "snow_surface.h"

#ifndef SNOWBOUGH_GLSL
namespace snowbough::shared {
#endif

/// Greatest depth of bare places below the receiver's surface, as a fraction of the carrier's thickness.
KERNEL_CONSTANT float kSinkPart = 0.45f;
/// A carrier thicker than the first fraction of the snow depth is wide; one thinner than the second fraction is narrow.
KERNEL_CONSTANT float kWide = 0.8f;
KERNEL_CONSTANT float kNarrow = 0.3f;

/// Noise of the relief. `place`: as for point_noise.
SNOWBOUGH_SHARED_FUNCTION float relief_noise(vec3 place) {
  return layered_noise(place + 21.0f, vec3(4.0f, 1.7f, 0.8f), 0.65f);
}

/// The noise of a point, without its bumps. `place`: position divided by the snow depth at the shot's end, so that the
/// noise is the same at any scale.
SNOWBOUGH_SHARED_FUNCTION SnowPoint point_noise(vec3 place) {
  SnowPoint point;
  point.patches = layered_noise(place + 50.0f, vec3(2.2f, 1.0f, 0.45f), 0.8f);
  point.hem = layered_noise(place, vec3(3.0f, 1.5f, 0.6f), 0.7f);
  point.relief = relief_noise(place);
  point.bumps = 0.0f;
  point.deepest = 1e9f;
  point.convexity = 0.0f;
  point.narrow = 0.0f;
  return point;
}

/// Noise of the bumps. `place`: position on the shown surface, in the same unit as for point_noise.
SNOWBOUGH_SHARED_FUNCTION float bump_noise(vec3 place) {
  return layered_noise(place + 70.0f, vec3(1.1f, 0.5f, 0.0f), 0.6f);
}

/// Adds the carrier's constants to a point. `thickness`: thickness of the carrier; `depth`: snow depth at the shot's
/// end, both in metres.
SNOWBOUGH_SHARED_FUNCTION SnowPoint on_carrier(KERNEL_CONST_REF(SnowPoint) point, float thickness, float depth) {
  SnowPoint made = point;
  made.deepest = max(kSinkPart * thickness, 1e-5f);
  made.narrow = eased(thickness, kWide * depth, kNarrow * depth);
  return made;
}

/// Adds the constants of a round limb to a point. `width`: width of the limb in metres. At 0 the limb counts as flat
/// and as narrow, so that most snow shows.
SNOWBOUGH_SHARED_FUNCTION SnowPoint on_limb(KERNEL_CONST_REF(SnowPoint) point, float width, float depth) {
  SnowPoint made = on_carrier(point, width, depth);
  made.convexity = width > 0.0f ? 2.0f / width : 0.0f;
  return made;
}

/// Height of the shown snow on a limb; 0 if no snow shows.
SNOWBOUGH_SHARED_FUNCTION float limb_height(KERNEL_CONST_REF(SnowPoint) point, KERNEL_CONST_REF(SnowStyle) style,
                                            KERNEL_CONST_REF(SnowEdge) edge, float thickness, float open_depth) {
  const float height = max(thin_snow(edge, thickness), 0.0f);
  return swept_height(point, height + surface_relief(point, style, height, open_depth));
}

/// Upper bound of the distance between a point away from rims and its carrier, for snow up to `thickness` in the map.
SNOWBOUGH_SHARED_FUNCTION float farthest_offset(float thickness, KERNEL_CONST_REF(SnowStyle) style) {
  const float height = (1.0f + style.relief * kMaxRelief) * most_shown(thickness);
  return thickness > 0.0f ? height * length(vec3(1.0f, style.overhang * kMaxSag, 0.0f)) : 0.0f;
}

#ifndef SNOWBOUGH_GLSL
}  // namespace snowbough::shared
#endif
