// GLSL only: the texel under a pixel's centre.
#include "../lib/projection_frame.h"
#include "../lib/tile_pixel.h"

/// See TriangleSetup.
uniform samplerBuffer triangle_corners;
/// Two vectors per triangle: uv of its corners.
uniform samplerBuffer map_triangles;
/// Per slot: offset from a scene triangle's index to its index in the map triangles.
uniform isamplerBuffer map_offsets;
/// One SeenPixel per pixel.
uniform usamplerBuffer occlusion;
/// See native/snow/step/gl/geometry/geometry_deposit.h.
uniform usampler2DArray owners;
uniform usampler2DArray charts;
uniform usamplerBuffer main_texels;
/// Slots of the objects whose maps are in this group: [first, end); layer = slot - first.
uniform uvec2 group_objects;
uniform ivec2 tile_origin;

/// 1 + index in the map group of the texel that receives the snow under the centre of a pixel of the tile; 0 if there
/// is none. It is the texel at that point if that texel belongs to the triangle's chart. Otherwise it is the nearest
/// surrounding texel of the chart, to which the part in the other chart's texel is assigned. Otherwise it is the texel
/// that holds most of the triangle. Each of these texels holds a part of the visible triangle.
uint texel_under(ivec2 pixel, uint triangle, uint slot) {
  const vec2 a = texelFetch(triangle_corners, 3 * int(triangle)).xy;
  const vec2 ab = texelFetch(triangle_corners, 3 * int(triangle) + 1).xy - a;
  const vec2 ac = texelFetch(triangle_corners, 3 * int(triangle) + 2).xy - a;
  const int map_index = int(triangle) + texelFetch(map_offsets, int(slot)).x;
  const vec4 uv_ab = texelFetch(map_triangles, 2 * map_index);
  const uvec2 main_texel = texelFetch(main_texels, map_index).xy;

  const vec2 offset = vec2(pixel + tile_origin) + 0.5 - a;
  const float area = ab.x * ac.y - ab.y * ac.x;
  vec2 weights = area == 0.0 ? vec2(1.0 / 3.0)
                             : vec2(offset.x * ac.y - offset.y * ac.x,
                                    ab.x * offset.y - ab.y * offset.x) / area;
  weights = clamp(weights, 0.0, 1.0);
  weights /= max(weights.x + weights.y, 1.0);
  const vec2 uv_b = uv_ab.zw - uv_ab.xy;
  const vec2 uv_c = texelFetch(map_triangles, 2 * map_index + 1).xy - uv_ab.xy;
  const vec2 uv = uv_ab.xy + weights.x * uv_b + weights.y * uv_c;

  const int resolution = textureSize(owners, 0).x;
  const int layer = int(slot - group_objects.x);
  const ivec2 centre = clamp(ivec2(uv * float(resolution)), ivec2(0), ivec2(resolution - 1));
  uint best = main_texel.x;
  float least = 1e30;
  ivec2 at = centre;
  // Test the texel itself first, and its eight neighbours only if it does not fit. This is one loop, so that software
  // renderers skip the neighbours (CONTRIBUTING.md).
  int i = -1;
  bool good;
  do {
    const uint owner = texelFetch(owners, ivec3(at, layer), 0).x;
    const vec2 away = vec2(at) + 0.5 - uv * float(resolution);
    good = owner != 0u && texelFetch(charts, ivec3(at, layer), 0).x == main_texel.y;
    if (good && dot(away, away) < least) {
      best = owner;
      least = dot(away, away);
    }
    good = good && i < 0;
    ++i;
    at = clamp(centre + ivec2(i % 3, i / 3) - 1, ivec2(0), ivec2(resolution - 1));
  } while (!good && i < 9);
  return best;
}
