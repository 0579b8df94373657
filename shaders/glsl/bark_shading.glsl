// The bark's colour and bump mapping, per pixel, on the smooth limb: the tessellated displacement does not affect it,
// so nothing pops where the level changes.
#include "glsl/bark.glsl"
#include "glsl/lighting.glsl"
#include "glsl/relief.glsl"

/// Cosine between the limb's normal and the sun's direction above which bumps receive the sun's full light.
const float kTerminator = 0.15;

/// Width of a furrow's round bottom in pixels, as a change of the noise: narrower ones would be dashes.
const float kFurrowBottom = 2.0;

/// The bark's height, -1 to 1, and its slopes, limited to the detail that a pixel can show. `bark`: coordinates,
/// circumference and amplitude (m).
vec3 pixel_relief(vec3 position, vec4 bark) {
  const float away = max(distance(position, view.eye.xyz), 1e-6);
  return bark_relief(bark.xy, bark.z * view.eye.w / away, kFurrowBottom);
}

/// Position of a pixel's colour between those of furrows, 0, and ridges, 1.
float bark_share(float height) {
  return clamp(0.5 + 0.6 * height, 0.0, 1.0);
}

/// Linear light of a pixel of this relief and colour. Differences of heights between pixels would break narrow furrows
/// into dashes, so the rise comes from the slopes.
vec3 shaded_bark(vec3 position, vec3 smooth_normal, vec4 bark, vec3 relief, vec3 albedo) {
  const vec3 normal = normalize(smooth_normal);
  // Bumps use the furrows' real depth; their slope within a pixel is damped.
  vec3 shaded = normal;
  if (bark.w > 0.0) {
    const vec2 rise = vec2(dot(relief.yz, dFdx(bark.xy)), dot(relief.yz, dFdy(bark.xy)));
    shaded = with_rise(position, normal, bark.w * rise + relief.x * vec2(dFdx(bark.w), dFdy(bark.w)));
  }
  if (dot(shaded, normal) < 0.0) {
    shaded = normal;
  }
  // Bumps do not catch light where the limb itself turns away from the sun.
  const vec3 to_sun = view.sun_direction.xyz;
  const float sun = max(dot(shaded, to_sun), 0.0) * smoothstep(0.0, kTerminator, dot(normal, to_sun));
  return lit_by(sun, albedo, position, normal, shaded);
}
