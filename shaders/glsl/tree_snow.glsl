// Snow on limbs by the common formula in lib/snow_surface.h. Limbs are round and have no rims. The noise is fixed to
// the rest pose.
#include "glsl/snow_map.glsl"
#include "glsl/tree_instance.glsl"
#include "lib/snow_point.h"

/// Snow depth on open level ground in metres: in this picture, and at the shot's end.
float open_depth() { return tree.snow.x; }
float last_depth() { return tree.snow.y; }

/// Noise at a position in the rest pose: patches, hem, relief and bumps of a SnowPoint.
vec4 limb_noise(vec3 rest) {
  const vec3 place = rest / last_depth();
  const SnowPoint point = point_noise(place);
  return vec4(point.patches, point.hem, point.relief, bump_noise(place));
}

SnowPoint limb_point(vec4 noise, float circumference) {
  const SnowPoint point = SnowPoint(noise.x, noise.y, noise.z, noise.w, 0.0, 0.0, 0.0);
  return on_limb(point, circumference / 3.1415927, last_depth());
}

/// Height of the shown snow above the bark, 0 where no snow shows. `up`: upward component of the limb's normal.
float shown_snow(SnowPoint point, float thickness, float up) {
  return limb_height(point, tree.style, snow_edge(point, thickness, open_depth(), up), thickness, open_depth());
}

/// Offset from the bark to the snow's surface.
vec3 snow_offset(SnowPoint point, float thickness, vec3 normal) {
  const float height = shown_snow(point, thickness, normal.z);
  const vec3 down = normal * normal.z - vec3(0.0, 0.0, 1.0);
  const float slope = length(down);
  if (height <= 0.0 || slope < 1e-3) {
    return normal * height;
  }
  const SnowEdge edge = snow_edge(point, thickness, open_depth(), normal.z);
  return normal * height + down * (sagging(point, tree.style, edge, thickness, height, normal.z) / slope);
}
