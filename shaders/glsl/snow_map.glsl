// The height map of the instance `tree`, in pages of one array texture. It is fetched texel by texel, because the
// interpolation of texture units has steps of 1 / 256 texel.
#include "glsl/tree_instance.glsl"
#include "lib/map_tiles.h"

/// Metres, negative on the back of the surface; row 0 at v = 0.
uniform sampler2DArray snow_pages;

float snow_texel(int x, int y) {
  const ivec2 page = ivec2(x, y) / kSnowPage;
  return texelFetch(snow_pages, ivec3(ivec2(x, y) - kSnowPage * page, snow_page(page, tree.map)), 0).x;
}

/// Bilinear interpolation of the height. It suits the tight layouts of trees, whose charts are one texel apart.
float height_between(vec2 uv) {
  const ivec2 last = tree.map.xy - 1;
  const vec2 at = uv * vec2(last + 1) - 0.5;
  const ivec2 low = ivec2(floor(at));
  const vec2 f = at - floor(at);
  const ivec2 a = clamp(low, ivec2(0), last);
  const ivec2 b = clamp(low + 1, ivec2(0), last);
  return mix(mix(snow_texel(a.x, a.y), snow_texel(b.x, a.y), f.x), mix(snow_texel(a.x, b.y), snow_texel(b.x, b.y), f.x),
             f.y);
}
