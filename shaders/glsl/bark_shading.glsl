// The bark's colour and its relief, per pixel, on the smooth limb: what the tessellation has already made of it does
// not show, so nothing pops where the level changes.
#include "glsl/bark.glsl"
#include "glsl/lighting.glsl"

/// Source of the normal: M. S. Mikkelsen, Bump Mapping Unparametrized Surfaces on the GPU, 2010.
vec3 with_relief(vec3 position, vec3 normal, float height) {
  const vec3 x = dFdx(position);
  const vec3 y = dFdy(position);
  const vec3 r1 = cross(y, normal);
  const vec3 r2 = cross(normal, x);
  const float det = dot(x, r1);
  const vec3 gradient = sign(det) * (dFdx(height) * r1 + dFdy(height) * r2);
  return normalize(abs(det) * normal - gradient);
}

/// `bark`: coordinates, circumference and rise (m).
vec4 shaded_bark(vec3 position, vec3 smooth_normal, vec4 bark) {
  const vec3 normal = normalize(smooth_normal);
  const float away = max(distance(position, view.eye.xyz), 1e-6);
  const float samples = bark.z * view.eye.w / away;
  const float height = bark_height(bark.xy, samples);
  // The furrows' depth is real where the relief is drawn; a pixel's own slope is damped to what a pixel shows.
  vec3 shaded = normal;
  if (bark.w > 0.0) {
    shaded = with_relief(position, normal, bark.w * height);
  }
  if (dot(shaded, normal) < 0.0) {
    shaded = normal;
  }
  const vec3 albedo = mix(view.bark_dark.rgb, view.bark_light.rgb, clamp(0.5 + 0.6 * height, 0.0, 1.0));
  return encoded(lit(albedo, position, normal, shaded, 0.0));
}
