#pragma once

// The deposit for one texel, gathered: every fragment that faces the fall gains what falls on it, times the
// part of it that sees the sky. Nothing is shared out among texels and nothing is added up per pixel, so that
// an evenly lit surface is evenly covered whatever the sizes of its texels and of the pixels.
#include "facing.h"
#include "projection_frame.h"
#include "kernel.h"
#include "texel_surface.h"
#include "visibility.h"

/// A MapTriangle each, in two vectors.
KERNEL_VIEW_RGBA32F(map_triangles);
#ifdef WITH_OPACITY
/// Per fragment: the part of it that is there for snow.
KERNEL_VIEW_R32F(fragment_opacity);
#endif
/// A TexelStep each, as one vector.
KERNEL_BLOCK(TexelSteps, uvec4, texel_steps);
/// Texels a side of the map.
KERNEL_UNIFORM(float, resolution);
/// Whether what the step's earlier tiles brought is in texel_steps.
KERNEL_UNIFORM(int, goes_on);

/// A fragment is sampled in cells of at most so many pixels, in so many cells along each side: beyond that
/// the cells grow, and the steps' samples fall on other places in them.
KERNEL_CONSTANT float kCellPixels = 1.5f;
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
  float side;
  /// Texels that it covers.
  float texels;
};

KERNEL_MEMO(GainTriangle, last_triangle)

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
  found.side = texelFetch(triangle_surface, triangle).w;
  found.texels = 0.5f * abs(twice);
  return found;
}

/// Where a fragment is looked at: in cells, one sample each. Alike for all that hold the same share of a
/// triangle.
struct FragmentCells {
  int along_u;
  int along_v;
  /// From the fragment's centroid to the first sample, and from cell to cell, in weights of the triangle's
  /// second and third corner.
  vec2 first;
  vec2 step_u;
  vec2 step_v;
  /// How many cells are as wide and as high as a pixel.
  vec2 windows;
  /// Of each in all of them.
  float part;
};

KERNEL_MEMO(FragmentCells, last_cells)

/// The cells along one side of a fragment, which is `extent` pixels long.
int cell_count(vec2 extent) {
  return clamp(int(ceil(max(abs(extent.x), abs(extent.y)) / kCellPixels)), 1, kMostCells);
}

/// Where in its cell a sample lies, 0 to 1.
float place_in_cell(vec2 extent, int cells, float shift) {
  return max(abs(extent.x), abs(extent.y)) > kCellPixels * float(cells) ? shift : 0.5f;
}

/// How far weights reach on the grid.
vec2 extent_of(KERNEL_CONST_REF(GainTriangle) own, vec2 weights) {
  return weights.x * vec2(own.edge_b) + weights.y * vec2(own.edge_c);
}

FragmentCells fragment_cells(KERNEL_CONST_REF(GainTriangle) own, float share) {
  // Within a texel, a fragment is looked at as a square as large as it is.
  const float size = sqrt(min(1.0f, share * own.texels));
  const vec2 extent_u = extent_of(own, own.along_u * size);
  const vec2 extent_v = extent_of(own, own.along_v * size);
  FragmentCells cells;
  cells.along_u = cell_count(extent_u);
  cells.along_v = cell_count(extent_v);
  cells.step_u = own.along_u * (size / float(cells.along_u));
  cells.step_v = own.along_v * (size / float(cells.along_v));
  cells.first =
      (place_in_cell(extent_u, cells.along_u, cell_shift(projection).x) - 0.5f * float(cells.along_u)) * cells.step_u +
      (place_in_cell(extent_v, cells.along_v, cell_shift(projection).y) - 0.5f * float(cells.along_v)) * cells.step_v;
  // Half of its cell: what is seen of the rest are the same pixels or its neighbours'.
  cells.windows = 1.0f / clamp(0.5f * (abs(extent_u) / float(cells.along_u) + abs(extent_v) / float(cells.along_v)),
                               kLeastWindow, 1.0f);
  cells.part = 1.0f / float(cells.along_u * cells.along_v);
  return cells;
}

/// The point of a triangle with these weights of its second and third corner; of weights beside the triangle,
/// one on its rim.
vec3 point_on(KERNEL_CONST_REF(GainTriangle) own, vec2 weights) {
  vec2 inside = max(weights, 0.0f);
  const float sum = inside.x + inside.y;
  if (sum > 1.0f) {
    inside /= sum;
  }
  return own.corner + inside.x * own.edge_b + inside.y * own.edge_c;
}

/// What falls on the point with these weights; `most`: what would where it sees all of the sky. Each point is
/// looked at in the one tile that its pixel belongs to.
uint point_gain(uint triangle, KERNEL_CONST_REF(GainTriangle) own, vec2 weights, vec2 windows, float most) {
  PlanePoint point;
  point.at = point_on(own, weights);
  point.gradient = own.gradient;
  point.hair = own.hair;
  point.pixel_depth = own.pixel_depth;
  point.side = own.side;
  point.triangle = triangle;
  const ivec2 pixel = ivec2(floor(vec2(point.at))) - tile_origin;
  return is_in_tile(pixel) ? uint(most * seen_part(point, windows) + 0.5f) : 0u;
}

/// What a fragment gains in this tile; `most`: what it would gain where all of it sees the sky.
uint fragment_gain(uvec4 fragment, KERNEL_CONST_REF(GainTriangle) own, float most) {
  KERNEL_CONST_REF(FragmentCells) cells =
      KERNEL_MEMOIZED(last_cells, uvec2(fragment.x, fragment.y), fragment_cells(own, uintBitsToFloat(fragment.y)));
  const vec2 first = vec2(uintBitsToFloat(fragment.z), uintBitsToFloat(fragment.w)) + cells.first;
  const float most_a_cell = most * cells.part;
  uint gain = 0u;
  for (int v = 0; v < cells.along_v; ++v) {
    for (int u = 0; u < cells.along_u; ++u) {
      gain += point_gain(fragment.x, own, first + float(u) * cells.step_u + float(v) * cells.step_v,
                         cells.windows, most_a_cell);
    }
  }
  return gain;
}

/// What falls on a fragment where it sees all of the sky, as part of what lies across the fall; `surface`: its
/// triangle's. Where that is shaded smooth, its smooth points say so (smooth_points.h).
float falling_on(uvec4 fragment, vec4 surface) {
#ifdef WITH_SHADING
  if (is_smooth(fragment.x)) {
    const vec4 there = smooth_at(fragment);
    return front_part(surface.x) * (surface.w < 0.0f ? there.y : there.x);
  }
#endif
  return surface.x;
}

/// What texel `index` finds out in this tile: a TexelStep. All that falls on a texel is to lie on one side of it; at
/// a fold, where both face the fall, that is found when all tiles have been looked at. `map_offset`: from a scene
/// triangle's index to its index among map_triangles.
void gather_texel(int index, int map_offset) {
  const int begin = int(texelFetch(fragment_begin, index).x);
  const int end = int(texelFetch(fragment_begin, index + 1).x);
  const TexelSurface surface = surface_of(begin, end);
  const bool mixed = surface.faces_front && surface.faces_back;
  const float units = mixed ? kMixedUnits : kGainUnits;
  uint gain = goes_on != 0 ? texel_steps[index].x & ~(kBackSide | kMixedSides) : 0u;
  for (int i = begin; i < end; ++i) {
    const uvec4 fragment = uvec4(texelFetch(fragments, i));
    const vec4 of_triangle = texelFetch(triangle_surface, int(fragment.x));
    float area = uintBitsToFloat(fragment.y) * of_triangle.y;
#ifdef WITH_OPACITY
    area *= KERNEL_IS_BOUND(fragment_opacity) ? texelFetch(fragment_opacity, i).x : 1.0f;
#endif
    if (of_triangle.x > 0.0f && area > 0.0f) {
      KERNEL_CONST_REF(GainTriangle) own =
          KERNEL_MEMOIZED(last_triangle, uvec2(fragment.x, 0u),
                      gain_triangle(int(fragment.x), int(fragment.x) + map_offset));
      const float falls = falling_on(fragment, of_triangle) * (area / surface.area);
      gain += fragment_gain(fragment, own, falls * units) << (mixed && of_triangle.w < 0.0f ? kMixedBits : 0u);
    }
  }
  const uint side = mixed ? kMixedSides : surface.faces_back ? kBackSide : 0u;
  texel_steps[index] = uvec4(gain | side, floatBitsToUint(surface.area), floatBitsToUint(surface.up),
                             floatBitsToUint(surface.back_up));
}
