// Second part of the deposit: texels that together cover less than half of their pixel take no more
// than half a pixel would hold; the rest (everything, where none takes part) goes to the texel under
// the pixel's centre. Counts what the sky sees of every object.
#include "fall_frame.h"

layout(local_size_x = 64) in;
layout(std430) readonly buffer Positions { float positions[]; };
layout(std430) readonly buffer Triangles { SceneTriangle triangles[]; };
layout(std430) readonly buffer TriangleSurface { vec4 triangle_surface[]; };
layout(std430) readonly buffer MapTriangles { MapTriangle map_triangles[]; };
layout(std430) readonly buffer TexelSurface { vec4 texel_surface[]; };
/// Thickness in units of step depth / kDepthUnits, saturating.
layout(std430) buffer DepositUnits { uint deposit_units[]; };
layout(std430) buffer Counts { PixelCounts counts[]; };
/// By slot: what to add to a scene triangle's index to get its index among the map triangles.
layout(std430) readonly buffer MapOffsets { int map_offsets[]; };
uniform usampler2D occlusion;
uniform usampler2D weight_sum;
/// x: 1 + texel index in the map group, y: chart << 8 | coverage in 1/255.
uniform usampler2DArray owners;
/// Slots of the objects whose maps are in this group: [first, end); layer = slot - first.
uniform uvec2 group_objects;
/// Texels of the group in this batch: [first, end).
uniform uvec2 batch_texels;
uniform bool counting;
uniform ivec2 tile_origin;
uniform ivec2 tile_size;
uniform float step_depth;

const uint kPixelsEach = 16u;

vec3 corner(uint index) {
  return project(vec3(positions[3u * index], positions[3u * index + 1u], positions[3u * index + 2u]));
}

/// Texture coordinates of the point of a triangle under a local pixel position.
vec2 uv_under(vec2 at, SceneTriangle triangle, MapTriangle on_map) {
  const vec3 a = corner(triangle.a);
  const vec3 ab = corner(triangle.b) - a;
  const vec3 ac = corner(triangle.c) - a;
  const vec2 offset = at - a.xy;
  const float area = ab.x * ac.y - ab.y * ac.x;
  vec2 weights = area == 0.0 ? vec2(1.0 / 3.0)
                             : vec2(offset.x * ac.y - offset.y * ac.x,
                                    ab.x * offset.y - ab.y * offset.x) / area;
  weights = clamp(weights, 0.0, 1.0);
  weights /= max(weights.x + weights.y, 1.0);
  return on_map.uv_a + weights.x * (on_map.uv_b - on_map.uv_a) + weights.y * (on_map.uv_c - on_map.uv_a);
}

float uv_area(MapTriangle t) {
  const vec2 ab = t.uv_b - t.uv_a;
  const vec2 ac = t.uv_c - t.uv_a;
  return 0.5 * abs(ab.x * ac.y - ab.y * ac.x);
}

/// The texel that takes the snow at `uv`: the one there, if it is the chart's own and no sliver
/// beside the pixel; else the chart's best of the eight around it; else the triangle's home.
uint texel_under(vec2 uv, MapTriangle on_map, float triangle_projected, int layer) {
  const int resolution = textureSize(owners, 0).x;
  const ivec2 centre = clamp(ivec2(uv * float(resolution)), ivec2(0), ivec2(resolution - 1));
  const uvec2 own = texelFetch(owners, ivec3(centre, layer), 0).xy;
  const float pixel_area = fall.direction.w * fall.direction.w;
  const float texel_area =
      triangle_projected / max(uv_area(on_map) * float(resolution) * float(resolution), 1e-12);
  if (own.x != 0u && own.y >> 8u == on_map.chart) {
    const float coverage = float(own.y & 255u) / 255.0;
    if (coverage >= 0.5 || coverage * texel_area >= 0.5 * pixel_area) {
      return own.x;
    }
  }
  uint best = on_map.home;
  uint best_coverage = 0u;
  for (int y = -1; y <= 1; ++y) {
    for (int x = -1; x <= 1; ++x) {
      const ivec2 at = centre + ivec2(x, y);
      if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, ivec2(resolution)))) {
        continue;
      }
      const uvec2 owner = texelFetch(owners, ivec3(at, layer), 0).xy;
      if (owner.x != 0u && owner.y >> 8u == on_map.chart && (owner.y & 255u) > best_coverage) {
        best = owner.x;
        best_coverage = owner.y & 255u;
      }
    }
  }
  return best;
}

void add_saturating(uint texel, uint units) {
  uint seen = deposit_units[texel];
  uint before;
  do {
    before = seen;
    const uint after = before > kNowhere - units ? kNowhere : before + units;
    seen = atomicCompSwap(deposit_units[texel], before, after);
  } while (seen != before);
}

/// Puts what a pixel's texels do not take onto the texel under its centre; true when there is none.
bool is_homeless(ivec2 pixel, uint index, SceneTriangle triangle, uint slot) {
  const uint half_pixel = kPixelWeight / 2u;
  const uint sum = texelFetch(weight_sum, pixel, 0).x;
  if (sum >= half_pixel) {
    return false;
  }
  const float left = 1.0 - float(sum) / float(half_pixel);
  const MapTriangle on_map = map_triangles[int(index) + map_offsets[slot]];
  const vec2 uv = uv_under(vec2(pixel + tile_origin) + 0.5, triangle, on_map);
  const vec4 surface = triangle_surface[index];
  const float projected = surface.w * abs(dot(surface.xyz, fall.direction.xyz));
  const uint owner = texel_under(uv, on_map, projected, int(slot - group_objects.x));
  if (owner == 0u) {
    return true;
  }
  const uint texel = owner - 1u;
  if (texel >= batch_texels.x && texel < batch_texels.y) {
    const float area = texel_surface[texel - batch_texels.x].w;
    const float thickness =
        left * snow_of_pixel(pixel + tile_origin) * fall.direction.w * fall.direction.w / area;
    add_saturating(texel - batch_texels.x,
                   uint(min(thickness / step_depth * kDepthUnits + 0.5, 4294967040.0)));
  }
  return false;
}

void flush(uint slot, inout PixelCounts count) {
  if (count.visible > 0u) {
    atomicAdd(counts[slot].visible, count.visible);
  }
  if (count.back_facing > 0u) {
    atomicAdd(counts[slot].back_facing, count.back_facing);
  }
  if (count.homeless > 0u) {
    atomicAdd(counts[slot].homeless, count.homeless);
  }
  if (count.snowed > 0u) {
    atomicAdd(counts[slot].snowed, count.snowed);
  }
  count = PixelCounts(0u, 0u, 0u, 0u);
}

void main() {
  // A work group walks along a row, each lane every 64th pixel: counts change hands rarely.
  const int y = int(gl_WorkGroupID.y);
  const int begin = int(gl_WorkGroupID.x * kPixelsEach * 64u + gl_LocalInvocationID.x);
  uint current = 0u;
  PixelCounts count = PixelCounts(0u, 0u, 0u, 0u);
  for (uint i = 0u; i < kPixelsEach; ++i) {
    const ivec2 pixel = ivec2(begin + int(i * 64u), y);
    if (pixel.x >= tile_size.x) {
      break;
    }
    const uint seen = texelFetch(occlusion, pixel, 0).x;
    if (seen == 0u) {
      continue;
    }
    const uint index = (seen & ~kBackFace) - 1u;
    const SceneTriangle triangle = triangles[index];
    const uint slot = triangle.object & ~kReceives;
    if ((triangle.object & kReceives) == 0u || slot < group_objects.x || slot >= group_objects.y) {
      continue;
    }
    if (slot != current) {
      flush(current, count);
      current = slot;
    }
    if ((seen & kBackFace) != 0u) {
      count.back_facing += counting ? 1u : 0u;
      continue;
    }
    const bool homeless = is_homeless(pixel, index, triangle, slot);
    if (counting) {
      count.visible += 1u;
      count.homeless += homeless ? 1u : 0u;
      count.snowed += snow_of_pixel(pixel + tile_origin) > 0.0 ? 1u : 0u;
    }
  }
  flush(current, count);
}
