// SPDX-License-Identifier: GPL-3.0-or-later
// White snow in soft light, cut where it is too thin to be seen.

// Thickness at which the raised surface comes out of the one below it (metres).
const float CUT = 0.0003;
const vec3 SHADE = vec3(0.47, 0.55, 0.67);
const vec3 WHITE = vec3(0.97, 0.975, 0.98);

/// The interpolated normal; the triangle's own on the slope at the rim of an open mesh, of which the map knows nothing.
vec3 shading_normal() {
  vec3 smooth_normal = normalize(snow_normal);
  vec3 flat_normal = cross(dFdx(snow_place), dFdy(snow_place));
  float size = length(flat_normal);
  if (!(size > 1e-20)) {
    return smooth_normal;
  }
  flat_normal *= (dot(smooth_normal, flat_normal) < 0.0 ? -1.0 : 1.0) / size;
  return normalize(mix(flat_normal, smooth_normal, smoothstep(0.0, 1.0, snow_inside)));
}

void main() {
  float covered = clamp((snow_thickness - CUT) / max(fwidth(snow_thickness), 1e-7) + 0.5, 0.0, 1.0);
  if (covered < 0.02) {
    discard;
  }
  vec3 normal = shading_normal();
  // Light that wraps around, as it does in snow, and some from above.
  float sun = 0.5 + 0.5 * dot(normal, light.xyz);
  float sky = 0.5 + 0.5 * normal.z;
  vec3 color = mix(SHADE, WHITE, clamp(0.85 * sun * sun * sun + 0.18 * sky, 0.0, 1.0));
  // The view's target takes linear colors.
  fragment_color = vec4(pow(color, vec3(2.2)), covered * light.w);
}
