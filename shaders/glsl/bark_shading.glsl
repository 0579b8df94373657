// The bark's colour and bump mapping, per pixel, on the smooth limb: the tessellated displacement does not affect it,
// so nothing pops where the level changes.
#include "glsl/bark.glsl"
#include "glsl/lighting.glsl"
#include "glsl/relief.glsl"

/// The bark's height, -1 to 1, limited to the detail that a pixel can show. `bark`: coordinates, circumference and
/// amplitude (m).
float bark_relief(vec3 position, vec4 bark) {
  const float away = max(distance(position, view.eye.xyz), 1e-6);
  return bark_height(bark.xy, bark.z * view.eye.w / away);
}

/// Position of a pixel's colour between those of furrows, 0, and ridges, 1.
float bark_share(float height) {
  return clamp(0.5 + 0.6 * height, 0.0, 1.0);
}

/// Linear light of a pixel of this height and colour.
vec3 shaded_bark(vec3 position, vec3 smooth_normal, vec4 bark, float height, vec3 albedo) {
  const vec3 normal = normalize(smooth_normal);
  // Bumps use the furrows' real depth; their slope within a pixel is damped.
  vec3 shaded = normal;
  if (bark.w > 0.0) {
    shaded = with_relief(position, normal, bark.w * height);
  }
  if (dot(shaded, normal) < 0.0) {
    shaded = normal;
  }
  return lit(albedo, position, normal, shaded, 0.0);
}
