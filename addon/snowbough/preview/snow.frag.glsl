// SPDX-License-Identifier: GPL-3.0-or-later
// White snow in soft light.

const vec3 SHADE = vec3(0.47, 0.55, 0.67);
const vec3 WHITE = vec3(0.97, 0.975, 0.98);

void main() {
  vec3 normal = normalize(snow_normal);
  // Wrapped diffuse light imitates scattering in snow; the second part is light from above.
  float sun = 0.5 + 0.5 * dot(normal, light.xyz);
  float sky = 0.5 + 0.5 * normal.z;
  vec3 light_there = mix(SHADE, WHITE, clamp(0.85 * sun * sun * sun + 0.18 * sky, 0.0, 1.0));
  // The view's target takes linear colors.
  color = vec4(pow(light_there, vec3(2.2)), light.w);
}
