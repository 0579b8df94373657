// A tree's height map. It is fetched texel by texel, because the interpolation of texture units has steps of 1 / 256
// texel.

/// Metres, negative on the back of the surface; row 0 at v = 0.
uniform sampler2D height_map;

/// Bilinear interpolation of the height. It suits the tight layouts of trees, whose charts are one texel apart.
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
