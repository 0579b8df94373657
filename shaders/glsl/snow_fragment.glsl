// A pixel of a receiver, plain or tessellated alike: its base, and the snow on it.
//
// SHADOW: depth alone. WIRE: the lines of a wireframe, or the paper that hides those behind.
#ifndef SHADOW
layout(location = 0) out vec4 color;
#ifdef WIRE
uniform vec4 wire_color;
#else
#include "glsl/snow_map.glsl"
#include "glsl/snow_shading.glsl"
/// Linear; w: 0 where the bare surface is somebody else's.
uniform vec4 base_color;
/// Cover below which nothing is to be seen of snow.
const float kLeastCover = 0.004;
in vec3 world;
in vec3 snow_direction;
in vec3 bare_normal;
in vec3 rest_place;
in vec2 map_place;
flat in vec3 u_gradient;
flat in vec3 v_gradient;

/// Most texels at a distance from which a slope is told: as far as maps go on beyond their charts.
const float kWidest = 3.5;

/// How the height changes along u and v, over as many texels as a pixel covers.
vec2 slope_by_pixel(vec2 slope) {
  const vec2 size = vec2(textureSize(height_map, 0));
  const vec2 across = fwidth(map_place * size);
  const float texels = max(across.x, across.y);
  const float share = smoothstep(0.7, 2.0, texels);
  if (share <= 0.0) {
    return slope;
  }
  const float apart = clamp(0.7 * texels, 1.0, kWidest);
  const vec2 u = vec2(apart / size.x, 0.0);
  const vec2 v = vec2(0.0, apart / size.y);
  const vec2 wide = vec2(textureLod(height_map, map_place + u, 0.0).x - textureLod(height_map, map_place - u, 0.0).x,
                         textureLod(height_map, map_place + v, 0.0).x - textureLod(height_map, map_place - v, 0.0).x) *
                    size / (2.0 * apart);
  return mix(slope, wide, share);
}
#endif
#endif

void main() {
#ifndef SHADOW
#ifdef WIRE
  color = wire_color;
#else
  const vec3 map = height_and_slope(map_place);
  const vec2 slope = slope_by_pixel(map.yz);
  const float side = map.x < 0.0 ? -1.0 : 1.0;
  const vec3 normal = side * normalize(normalize(snow_direction) - slope.x * u_gradient - slope.y * v_gradient);
  const float pixel = distance(view.eye.xyz, world) / view.eye.w;
  // Seen through the surface, snow on its other side is hidden by the base.
  const bool seen_from_behind = gl_FrontFacing == (side < 0.0);
  const float cover = seen_from_behind ? 0.0 : snow_cover(abs(map.x), rest_place, pixel);
  const vec3 bare = normalize(bare_normal) * (gl_FrontFacing ? 1.0 : -1.0);
  const vec3 snow = lit_snow(world, normal, abs(map.x), rest_place);
  const bool is_layer = base_color.w < 0.5;
  if (is_layer && cover < kLeastCover) {
    discard;  // behind all that takes derivatives
  }
  if (is_layer) {
    color = vec4(encoded(snow).rgb, cover);
  } else {
    color = encoded(mix(lit(base_color.rgb, world, bare, bare, 0.0), snow, cover));
  }
#endif
#endif
}
