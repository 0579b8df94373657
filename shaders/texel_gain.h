#pragma once

// The deposit for one texel, gathered: every fragment that faces the fall gains what falls on it, times the
// part of it that sees the sky. Nothing is shared out among texels and nothing is added up per pixel, so that
// an evenly lit surface is evenly covered whatever the sizes of its texels and of the pixels.
#include "fall_frame.h"
#include "kernel.h"
#include "texel_surface.h"
#include "visibility.h"

/// A MapTriangle each, in two vectors.
KERNEL_VIEW_RGBA32F(map_triangles);
#ifdef WITH_OPACITY
/// Per fragment: the part of it that is there for snow.
KERNEL_VIEW_R32F(fragment_opacity);
#endif
/// A TexelStep each, as one vector: llvmpipe stores it in one go.
KERNEL_BLOCK(TexelSteps, uvec4, texel_steps);
/// Texels a side of the map.
KERNEL_UNIFORM(float, resolution);
/// Whether what the step's earlier tiles brought is in texel_steps.
KERNEL_UNIFORM(int, goes_on);

/// A fragment is sampled in cells of at most so many pixels, in so many cells along each side: beyond that
/// the cells grow, and the steps' samples fall on other places in them.
KERNEL_CONSTANT float kCellPixels = 1.25f;
KERNEL_CONSTANT int kMostCells = 8;
KERNEL_CONSTANT float kLeastWindow = 1e-3f;

/// A triangle on the grid (pixels, metres of depth) and on its map.
struct GainTriangle {
  vec3 corner;
  vec3 edge_b;
  vec3 edge_c;
  /// What one texel along u and along v is in weights of the second and third corner.
  vec2 along_u;
  vec2 along_v;
  vec2 gradient;
  float hair;
  float pixel_depth;
  /// Texels that it covers.
  float texels;
};

KERNEL_MEMORY(GainTriangle, last_triangle)

/// `map_triangle`: its index among map_triangles.
GainTriangle gain_triangle(int triangle, int map_triangle) {
  const vec4 a = texelFetch(triangle_corners, 3 * triangle);
  const vec4 b = texelFetch(triangle_corners, 3 * triangle + 1);
  const vec4 c = texelFetch(triangle_corners, 3 * triangle + 2);
  const vec4 uv_ab = texelFetch(map_triangles, 2 * map_triangle);
  const vec4 uv_c = texelFetch(map_triangles, 2 * map_triangle + 1);
  const vec2 map_b = (vec2(uv_ab.z, uv_ab.w) - vec2(uv_ab.x, uv_ab.y)) * resolution;
  const vec2 map_c = (vec2(uv_c.x, uv_c.y) - vec2(uv_ab.x, uv_ab.y)) * resolution;
  const float twice = map_b.x * map_c.y - map_b.y * map_c.x;
  GainTriangle found;
  found.corner = vec3(a);
  found.edge_b = vec3(b) - vec3(a);
  found.edge_c = vec3(c) - vec3(a);
  found.along_u = vec2(map_c.y, -map_b.y) / twice;
  found.along_v = vec2(-map_c.x, map_b.x) / twice;
  found.gradient = vec2(a.w, b.w);
  found.hair = hair_of(found.gradient);
  found.pixel_depth = pixel_depth_of(c.w);
  found.texels = 0.5f * abs(twice);
  return found;
}

/// The cells along one side of a fragment, which is `extent` pixels long.
int cell_count(vec2 extent) {
  return clamp(int(ceil(max(abs(extent.x), abs(extent.y)) / kCellPixels)), 1, kMostCells);
}

/// Where in its cell a sample lies, 0 to 1.
float place_in_cell(vec2 extent, int cells, float shift) {
  return max(abs(extent.x), abs(extent.y)) > kCellPixels * float(cells) ? shift : 0.5f;
}

/// The point of a triangle with these weights of its second and third corner; of weights beside the triangle,
/// one on its rim.
vec3 point_on(KERNEL_CONST_REF(GainTriangle) own, vec2 weights) {
  const vec2 inside = max(weights, 0.0f);
  const float sum = max(inside.x + inside.y, 1.0f);
  return own.corner + (inside.x / sum) * own.edge_b + (inside.y / sum) * own.edge_c;
}

/// How far weights reach on the grid.
vec2 extent_of(KERNEL_CONST_REF(GainTriangle) own, vec2 weights) {
  return weights.x * vec2(own.edge_b) + weights.y * vec2(own.edge_c);
}

/// What a fragment gains in this tile; `most`: what it would gain where all of it sees the sky.
uint fragment_gain(uvec4 fragment, KERNEL_CONST_REF(GainTriangle) own, float most) {
  // Within a texel, a fragment is looked at as a square as large as it is.
  const float size = sqrt(min(1.0f, uintBitsToFloat(fragment.y) * own.texels));
  const vec2 side_u = own.along_u * size;
  const vec2 side_v = own.along_v * size;
  const vec2 extent_u = extent_of(own, side_u);
  const vec2 extent_v = extent_of(own, side_v);
  const int cells_u = cell_count(extent_u);
  const int cells_v = cell_count(extent_v);
  const float first_u = place_in_cell(extent_u, cells_u, fall.sampling.x) / float(cells_u) - 0.5f;
  const float first_v = place_in_cell(extent_v, cells_v, fall.sampling.y) / float(cells_v) - 0.5f;
  const vec2 window =
      clamp(abs(extent_u) / float(cells_u) + abs(extent_v) / float(cells_v), kLeastWindow, 1.0f);
  const vec2 centre = vec2(uintBitsToFloat(fragment.z), uintBitsToFloat(fragment.w));
  const float most_a_cell = most / float(cells_u * cells_v);
  uint gain = 0u;
  for (int v = 0; v < cells_v; ++v) {
    for (int u = 0; u < cells_u; ++u) {
      PlanePoint point;
      point.at = point_on(own, centre + (first_u + float(u) / float(cells_u)) * side_u +
                                   (first_v + float(v) / float(cells_v)) * side_v);
      point.gradient = own.gradient;
      point.hair = own.hair;
      point.pixel_depth = own.pixel_depth;
      point.triangle = fragment.x;
      // Each sample is looked at in the one tile that its pixel belongs to.
      const ivec2 pixel = ivec2(floor(vec2(point.at))) - tile_origin;
      if (is_in_tile(pixel)) {
        gain += uint(most_a_cell * seen_part(point, window) + 0.5f);
      }
    }
  }
  return gain;
}

/// What texel `index` finds out in this tile: a TexelStep. `map_offset`: from a scene triangle's index to its
/// index among map_triangles.
void gather_texel(int index, int map_offset) {
  const int begin = int(texelFetch(fragment_begin, index).x);
  const int end = int(texelFetch(fragment_begin, index + 1).x);
  const TexelSurface surface = surface_of(begin, end);
  uint gain = goes_on != 0 ? texel_steps[index].x : 0u;
  for (int i = begin; i < end; ++i) {
    const uvec4 fragment = uvec4(texelFetch(fragments, i));
    const vec4 of_triangle = texelFetch(triangle_surface, int(fragment.x));
    float area = uintBitsToFloat(fragment.y) * of_triangle.y;
#ifdef WITH_OPACITY
    area *= KERNEL_IS_BOUND(fragment_opacity) ? texelFetch(fragment_opacity, i).x : 1.0f;
#endif
    if (of_triangle.x > 0.0f && area > 0.0f) {
      KERNEL_CONST_REF(GainTriangle) own =
          KERNEL_KEPT(last_triangle, uvec2(fragment.x, 0u),
                      gain_triangle(int(fragment.x), int(fragment.x) + map_offset));
      gain += fragment_gain(fragment, own, of_triangle.x * (area / surface.area) * kGainUnits);
    }
  }
  texel_steps[index] = uvec4(gain, floatBitsToUint(surface.area), floatBitsToUint(surface.up), 0u);
}
