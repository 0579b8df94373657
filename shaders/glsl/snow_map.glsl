// A receiver's height map, interpolated by a uniform cubic B-spline: smooth heights with smooth slopes, however near
// the camera is. Fetched texel by texel, because the texture units' own interpolation has steps of 1 / 256 texel.

/// Metres, below 0 on the back of the surface; row 0 = v 0.
uniform sampler2D height_map;

/// Weights of four texels in a row around a place at a share `f` between the middle two.
vec4 spline_weights(float f) {
  const float g = 1.0 - f;
  return vec4(g * g * g, 4.0 - 3.0 * f * f * (2.0 - f), 4.0 - 3.0 * g * g * (2.0 - g), f * f * f) / 6.0;
}

/// Their derivatives by f.
vec4 spline_slopes(float f) {
  const float g = 1.0 - f;
  return vec4(-0.5 * g * g, 0.5 * f * (3.0 * f - 4.0), -0.5 * g * (3.0 * g - 4.0), 0.5 * f * f);
}

vec4 height_row(ivec2 at, int last) {
  return vec4(texelFetch(height_map, ivec2(clamp(at.x, 0, last), at.y), 0).x,
              texelFetch(height_map, ivec2(clamp(at.x + 1, 0, last), at.y), 0).x,
              texelFetch(height_map, ivec2(clamp(at.x + 2, 0, last), at.y), 0).x,
              texelFetch(height_map, ivec2(clamp(at.x + 3, 0, last), at.y), 0).x);
}

/// The height at a place of the map, and how it changes along u and v (m over the whole map).
vec3 height_and_slope(vec2 uv) {
  const ivec2 size = textureSize(height_map, 0);
  const vec2 at = uv * vec2(size) - 0.5;
  const ivec2 low = ivec2(floor(at)) - 1;
  const vec2 f = at - floor(at);
  const vec4 across = spline_weights(f.x);
  const vec4 across_slope = spline_slopes(f.x);
  vec4 rows;
  vec4 row_slopes;
  for (int k = 0; k < 4; ++k) {
    const vec4 row = height_row(ivec2(low.x, clamp(low.y + k, 0, size.y - 1)), size.x - 1);
    rows[k] = dot(across, row);
    row_slopes[k] = dot(across_slope, row);
  }
  const vec4 along = spline_weights(f.y);
  return vec3(dot(along, rows), dot(along, row_slopes) * float(size.x),
              dot(spline_slopes(f.y), rows) * float(size.y));
}

float height_at(vec2 uv) {
  return height_and_slope(uv).x;
}

/// The height between the four nearest texels: for layouts as tight as a tree's, whose charts lie a texel apart.
float height_between(vec2 uv) {
  const ivec2 last = textureSize(height_map, 0) - 1;
  const vec2 at = uv * vec2(last + 1) - 0.5;
  const ivec2 low = ivec2(floor(at));
  const vec2 f = at - floor(at);
  const ivec2 a = clamp(low, ivec2(0), last);
  const ivec2 b = clamp(low + 1, ivec2(0), last);
  return mix(mix(texelFetch(height_map, a, 0).x, texelFetch(height_map, ivec2(b.x, a.y), 0).x, f.x),
             mix(texelFetch(height_map, ivec2(a.x, b.y), 0).x, texelFetch(height_map, b, 0).x, f.x), f.y);
}
