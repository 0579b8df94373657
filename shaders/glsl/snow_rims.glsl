// How snow stands on its base, and how it ends: over a hard edge it leans to the mean of both faces' normals, within as
// far as it is deep, which makes a round rim; where the surface ends, it ends in a round shoulder. Distances are
// interpolated from the vertices'.
#include "lib/snow_patch.h"

/// A rim is as wide as this many depths, and as this many texels at least.
const float kRimDepths = 1.0;
const float kRimTexels = 1.5;
/// The same of the shoulder at the surface's end.
const float kShoulderDepths = 0.5;
const float kShoulderTexels = 0.5;

/// What snow of a height has of a bend: on a mesh that is shaded smooth it is rounder than the facets.
vec3 bent_under(vec3 bend, float height) {
  return bend * min(1.0, kMostBend * abs(height) / max(length(bend), 1e-9));
}

vec3 toward(vec3 from, vec3 to, float share) {
  const vec3 mean = mix(from, to, share);
  const float size = length(mean);
  return size > 1e-6 ? mean / size : from;
}

/// Where snow of a height grows to. `rim`: the direction at the nearest hard edge, w: metres to that.
vec3 leaning(vec3 normal, vec4 rim, float height, float texel) {
  const float share = clamp(rim.w / (kRimDepths * abs(height) + kRimTexels * texel + 1e-12), 0.0, 1.0);
  return toward(normal, vec3(rim), 1.0 - share * share * (3.0 - 2.0 * share));
}

/// What is left of a height at a distance from the surface's end: a quarter of a circle.
float shouldered(float height, float away, float texel) {
  const float left = 1.0 - clamp(away / (kShoulderDepths * abs(height) + kShoulderTexels * texel + 1e-12), 0.0, 1.0);
  return height * sqrt(max(1.0 - left * left, 0.0));
}
