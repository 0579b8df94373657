// SPDX-License-Identifier: GPL-3.0-or-later
// Raises a point of a receiver to the surface of its snow, as the shell of a bake does (result/shell_nodes.py).
// What it reads is declared by interface.py; metres throughout, in the world.

#define FETCHED(table, index) texelFetch(table, ivec2((index) % ROW, (index) / ROW), 0)

// See the constants of the same names in result/shell_nodes.py.
const float BARE = 1e-5;
const float SINK = 0.0004;
const float SKIN = 0.0004;
const float THIN = 0.001;
const float DEEP = 0.02;
const float WALL_SHARE = 0.05;
const float LEAN = 0.5;
const float MOST_CURVATURE = 0.5;

/// What the entries of a point say together.
struct Gathered {
  /// Offsets times weights, and the weights.
  vec4 offset;
  vec3 normal;
};

/// Weights of three texels in a row, and their change: a quadratic B-spline; t: -0.5 to 0.5 from the middle one.
vec3 spline(float t) { return vec3(0.5 * (0.5 - t) * (0.5 - t), 0.75 - t * t, 0.5 * (0.5 + t) * (0.5 + t)); }
vec3 spline_slope(float t) { return vec3(t - 0.5, -2.0 * t, t + 0.5); }

/// The height at a place on the map and its slopes along u and v, in metres and metres a map.
vec3 height_at(vec2 uv) {
  vec2 at = uv * map_size;
  vec2 middle = floor(at);
  vec2 t = at - middle - 0.5;
  vec3 along_u = spline(t.x), along_v = spline(t.y);
  vec3 slope_u = spline_slope(t.x), slope_v = spline_slope(t.y);
  ivec2 last = ivec2(int(map_size) - 1);
  vec3 sum = vec3(0.0);
  for (int y = 0; y < 3; ++y) {
    for (int x = 0; x < 3; ++x) {
      ivec2 texel = clamp(ivec2(middle) + ivec2(x - 1, y - 1), ivec2(0), last);
      float height = texelFetch(heights, texel, 0).x;
      sum += height * vec3(along_u[x] * along_v[y], slope_u[x] * along_v[y], along_u[x] * slope_v[y]);
    }
  }
  return vec3(sum.x, sum.yz * map_size);
}

/// The gradient along a surface of what has slopes (u, v), for the surface's ways along u and v.
vec3 gradient(vec2 slope, vec3 along_u, vec3 along_v) {
  float uu = dot(along_u, along_u), uv = dot(along_u, along_v), vv = dot(along_v, along_v);
  float area = uu * vv - uv * uv;
  if (!(area > 1e-7 * uu * vv)) {
    return vec3(0.0);
  }
  return ((slope.x * vv - slope.y * uv) * along_u + (slope.y * uu - slope.x * uv) * along_v) / area;
}

/// The direction in which snow grows: the normal on level ground, leaning up on slopes, the normal on walls.
vec3 leaning(vec3 outside) {
  float z = max(outside.z, 0.0);
  return normalize(outside + vec3(0.0, 0.0, z * (1.0 - z) * LEAN * 4.0));
}

vec3 interpolated(vec3 a, vec3 b, vec3 c, vec2 weight) {
  return a * (1.0 - weight.x - weight.y) + b * weight.x + c * weight.y;
}

void add_entry(inout Gathered sum, vec3 normal, vec3 edge1, vec3 edge2, vec4 tangents, vec2 uv) {
  vec3 height = height_at(uv);
  float side = height.x < 0.0 ? -1.0 : 1.0;
  float thickness = abs(height.x);
  vec3 outside = normal * side;
  vec3 along_u = tangents.x * edge1 + tangents.y * edge2;
  vec3 along_v = tangents.z * edge1 + tangents.w * edge2;
  // At an edge the side that faces the sky says where snow goes.
  float weight = thickness * max(outside.z, WALL_SHARE);
  sum.offset += vec4(leaning(outside) * (weight * thickness), weight);
  sum.normal += (outside - gradient(height.yz * side, along_u, along_v)) * (weight + 1e-9);
}

void add_further(inout Gathered sum, int index) {
  vec4 first = FETCHED(further, index * 4);
  vec4 second = FETCHED(further, index * 4 + 1);
  vec4 third = FETCHED(further, index * 4 + 2);
  vec4 tangents = FETCHED(further, index * 4 + 3);
  vec3 a = FETCHED(positions, int(first.x)).xyz;
  vec3 edge1 = FETCHED(positions, int(first.y)).xyz - a;
  vec3 edge2 = FETCHED(positions, int(first.z)).xyz - a;
  vec3 normal = interpolated(FETCHED(normals, int(second.x)).xyz, FETCHED(normals, int(second.y)).xyz,
                             FETCHED(normals, int(second.z)).xyz, vec2(first.w, second.w));
  add_entry(sum, normalize(normal + vec3(0.0, 0.0, 1e-12)), edge1, edge2, tangents, third.xy);
}

/// How far a point of a triangle is from the curved surface that the normals of its corners tell of: half of Phong
/// tessellation (T. Boubekeur, M. Alexa, 2008).
vec3 curvature(vec3 place, vec3 a, vec3 b, vec3 c, vec3 na, vec3 nb, vec3 nc, vec2 weight) {
  vec3 off = interpolated(na * dot(place - a, na), nb * dot(place - b, nb), nc * dot(place - c, nc), weight);
  return -0.5 * off;
}

void main() {
  vec3 a = FETCHED(positions, corners.x).xyz;
  vec3 b = FETCHED(positions, corners.y).xyz;
  vec3 c = FETCHED(positions, corners.z).xyz;
  vec3 na = FETCHED(normals, corner_normals.x).xyz;
  vec3 nb = FETCHED(normals, corner_normals.y).xyz;
  vec3 nc = FETCHED(normals, corner_normals.z).xyz;
  vec2 weight = weights.xy;
  vec3 place = interpolated(a, b, c, weight);
  vec3 normal = normalize(interpolated(na, nb, nc, weight) + vec3(0.0, 0.0, 1e-12));

  Gathered sum;
  sum.offset = vec4(0.0);
  sum.normal = vec3(0.0);
  add_entry(sum, normal, b - a, c - a, tangents, uv);
  for (int i = 0; i < more.y; ++i) {
    add_further(sum, more.x + i);
  }
  vec3 offset = sum.offset.xyz * (weights.z / max(sum.offset.w, BARE * WALL_SHARE));
  vec3 direction = normalize(offset + normal * 1e-9);
  float thickness = length(offset);
  // Thin snow stands a hair above the surface, bare places a hair below.
  float skin = mix(-SINK, SKIN, smoothstep(0.0, THIN, thickness)) * (1.0 - smoothstep(THIN, DEEP, thickness));
  vec3 bent = curvature(place, a, b, c, na, nb, nc, weight);
  bent *= min(1.0, MOST_CURVATURE * thickness / max(length(bent), 1e-9));

  snow_place = place + offset + direction * skin + bent;
  snow_normal = normalize(sum.normal + vec3(0.0, 0.0, 1e-12));
  snow_thickness = thickness;
  snow_inside = weights.z;
  gl_Position = view_projection * vec4(snow_place, 1.0);
  // In front of what it lies on, by as little as a depth buffer of 24 bits can tell.
  gl_Position.z -= DEPTH_BIAS * gl_Position.w;
}
