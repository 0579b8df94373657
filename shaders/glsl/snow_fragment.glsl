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
flat in vec3 edge_1;
flat in vec3 edge_2;
flat in vec3 turn_1;
flat in vec3 turn_2;
flat in vec4 map_edges;

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

/// How a height with these slopes over the map grows along a patch with the edges e1 and e2 (1).
vec3 gradient_on(vec3 e1, vec3 e2, vec2 slope) {
  const vec3 across = cross(e1, e2);
  const vec3 grows = dot(slope, map_edges.xy) * cross(e2, across) + dot(slope, map_edges.zw) * cross(across, e1);
  return grows / max(dot(across, across), 1e-30);
}

/// A direction turned as the shortest way from one unit vector to another turns.
vec3 turned(vec3 v, vec3 from, vec3 to) {
  const vec3 axis = cross(from, to);
  const vec3 once = cross(axis, v);
  return v + once + cross(axis, once) / max(1.0 + dot(from, to), 1e-3);
}

/// The same on the snow's surface: a layer of that height on a patch that is bent is wider than the patch or narrower,
/// and lies as the smooth normal has it, not as its facet does.
vec3 gradient_at(float height, vec2 slope) {
  const vec3 across = cross(edge_1, edge_2);
  const vec3 e1 = edge_1 + height * turn_1;
  const vec3 e2 = edge_2 + height * turn_2;
  const vec3 raised = cross(e1, e2);
  // Deep in a hollow a layer would be folded.
  const float open = smoothstep(0.1, 0.4, dot(raised, across) / max(dot(across, across), 1e-30));
  const vec3 gradient = mix(gradient_on(edge_1, edge_2, slope), gradient_on(e1, e2, slope), open);
  const float size = length(across);
  return size > 0.0 ? turned(gradient, across / size, normalize(bare_normal)) : gradient;
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
  const vec3 normal = side * normalize(normalize(snow_direction) - gradient_at(map.x, slope));
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
