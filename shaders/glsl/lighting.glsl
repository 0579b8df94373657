// Lighting by the sun with its shadow map, and by the sky. Takes linear colours and returns the target's encoding.
#include "glsl/tree_view.glsl"

uniform sampler2D shadow_map;

/// Fraction of the sun's light that reaches a point, over 3 x 3 texels with soft edges. `reach`: depth in metres inside
/// an occluder at which 1 / e of the light remains, as in snow; at 0 no light passes.
float sunlit(vec3 position, vec3 normal, float reach) {
  if (view.sun_direction.w < 0.5) {
    return 1.0;
  }
  const ivec2 size = textureSize(shadow_map, 0);
  // Offset by one texel along the normal, against self-shadowing.
  const float texel = 2.0 / (length(vec3(view.shadow_from_world[0].x, view.shadow_from_world[1].x,
                                         view.shadow_from_world[2].x)) *
                             float(size.x));
  vec3 at = (view.shadow_from_world * vec4(position + 2.0 * texel * normal, 1.0)).xyz * 0.5 + 0.5;
  // Points behind all shadow casters, such as distant ground, are behind the whole map.
  at.z = min(at.z, 1.0);
  if (any(lessThan(at, vec3(0.0))) || any(greaterThan(at, vec3(1.0)))) {
    return 1.0;
  }
  const vec2 pixel = at.xy * vec2(size) - 0.5;
  const ivec2 low = ivec2(floor(pixel));
  const vec2 part = pixel - vec2(low);
  const float depths_a_metre =
      0.5 * length(vec3(view.shadow_from_world[0].z, view.shadow_from_world[1].z, view.shadow_from_world[2].z));
  float open = 0.0;
  for (int y = -1; y <= 2; ++y) {
    const float weight_y = y < 0 ? 1.0 - part.y : y > 1 ? part.y : 1.0;
    for (int x = -1; x <= 2; ++x) {
      const float weight_x = x < 0 ? 1.0 - part.x : x > 1 ? part.x : 1.0;
      const ivec2 texel_at = clamp(low + ivec2(x, y), ivec2(0), size - 1);
      const float behind = at.z - texelFetch(shadow_map, texel_at, 0).x;
      float share = behind <= 0.0 ? 1.0 : 0.0;
      if (reach > 0.0 && behind > 0.0) {
        share = exp(-behind / (depths_a_metre * reach));
      }
      open += weight_x * weight_y * share;
    }
  }
  return open / 9.0;
}

/// Light reflected by a surface of this albedo under `sun`, the fraction of the sun's light that falls on it unless
/// something else hides it.
vec3 lit_by(float sun, vec3 albedo, vec3 position, vec3 geometric_normal, vec3 normal) {
  const vec3 sky = mix(view.ground_color.rgb, view.sky_color.rgb, 0.5 + 0.5 * normal.z);
  float open = 0.0;
  if (sun > 0.0) {
    const float side = dot(geometric_normal, view.sun_direction.xyz) < 0.0 ? -1.0 : 1.0;
    open = sunlit(position, side * geometric_normal, 0.0);
  }
  return albedo * (sun * open * view.sun_color.rgb + sky);
}

/// Light reflected by a surface of this albedo; `through`: fraction of the sun's light transmitted from behind.
vec3 lit(vec3 albedo, vec3 position, vec3 geometric_normal, vec3 normal, float through) {
  const float facing = dot(normal, view.sun_direction.xyz);
  return lit_by(max(facing, 0.0) + through * max(-facing, 0.0), albedo, position, geometric_normal, normal);
}

/// Light above this value is compressed if the target takes sRGB, so that sunlit snow keeps its shading instead of
/// clipping to white.
const float kToneShoulder = 0.25;

/// Linear light in the target's encoding, linear or sRGB, with an opaque alpha.
vec4 encoded(vec3 light) {
  if (view.sky_color.w > 0.5) {
    return vec4(light, 1.0);
  }
  const vec3 above = max(light - kToneShoulder, 0.0) / (1.0 - kToneShoulder);
  const vec3 c = clamp(min(light, kToneShoulder) + (1.0 - kToneShoulder) * above / (1.0 + above), 0.0, 1.0);
  const vec3 low = 12.92 * c;
  const vec3 high = 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055;
  return vec4(mix(high, low, lessThanEqual(c, vec3(0.0031308))), 1.0);
}
