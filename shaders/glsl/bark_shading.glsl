// The bark's colour and its relief, per pixel, on the smooth limb: what the tessellation has already made of it does
// not show, so nothing pops where the level changes.
#include "glsl/bark.glsl"
#include "glsl/lighting.glsl"
#include "glsl/relief.glsl"

/// The bark's height, -1 to 1, as much of it as a pixel shows. `bark`: coordinates, circumference and rise (m).
float bark_relief(vec3 position, vec4 bark) {
  const float away = max(distance(position, view.eye.xyz), 1e-6);
  return bark_height(bark.xy, bark.z * view.eye.w / away);
}

/// Between the colours of furrows and ridges.
vec3 bark_color(float height) {
  return mix(view.bark_dark.rgb, view.bark_light.rgb, clamp(0.5 + 0.6 * height, 0.0, 1.0));
}

/// Linear light of a pixel of this height and colour.
vec3 shaded_bark(vec3 position, vec3 smooth_normal, vec4 bark, float height, vec3 albedo) {
  const vec3 normal = normalize(smooth_normal);
  // The furrows' depth is real where the relief is drawn; a pixel's own slope is damped to what a pixel shows.
  vec3 shaded = normal;
  if (bark.w > 0.0) {
    shaded = with_relief(position, normal, bark.w * height);
  }
  if (dot(shaded, normal) < 0.0) {
    shaded = normal;
  }
  return lit(albedo, position, normal, shaded, 0.0);
}
