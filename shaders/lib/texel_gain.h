#pragma once

// The deposit for one texel, gathered: every fragment that faces the fall gains what falls on it, times the
// part of it that sees the sky. Nothing is shared out among texels and nothing is added up per pixel, so that
// an evenly lit surface is evenly covered whatever the sizes of its texels and of the pixels. All that falls on a
// texel is to lie on one side of it; at a fold, where both face the fall, that is found when all tiles have been
// looked at.
#include "facing.h"
#include "projection_frame.h"
#include "kernel.h"
#include "texel_surface.h"
#include "visibility.h"

/// A MapTriangle each, in two vectors.
KERNEL_VIEW_RGBA32F(map_triangles);
/// Texels a side of the map.
KERNEL_UNIFORM(float, resolution);

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
  float depth_bias;
  float pixel_depth;
  /// As in a PlanePoint.
  uint side_bit;
  uint side;
  /// Texels that it covers.
  float texels;
};

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
  found.depth_bias = depth_bias_of(found.gradient);
  found.pixel_depth = pixel_depth_of(c.w);
  const float side = surface_side(vec4(texelFetch(triangle_surface, triangle)));
  found.side_bit = side != 0.0f ? kBackFace : 0u;
  found.side = side < 0.0f ? kBackFace : 0u;
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

/// Within a texel, a fragment is looked at as a square as large as it is: its side in texels.
float fragment_side(KERNEL_CONST_REF(GainTriangle) own, float share) { return sqrt(min(1.0f, share * own.texels)); }

/// How many windows are as wide and as high as a pixel, where a cell has these sides: half of the cell each. What is
/// seen of its rest are the same pixels or its neighbours'.
vec2 windows_of(vec2 cell_u, vec2 cell_v) {
  return 1.0f / clamp(0.5f * (abs(cell_u) + abs(cell_v)), kLeastWindow, 1.0f);
}

FragmentCells fragment_cells(KERNEL_CONST_REF(GainTriangle) own, float share) {
  const float size = fragment_side(own, share);
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
  cells.windows = windows_of(extent_u / float(cells.along_u), extent_v / float(cells.along_v));
  cells.part = 1.0f / float(cells.along_u * cells.along_v);
  return cells;
}

/// The point of a triangle with these weights of its second and third corner; of weights beside the triangle,
/// one on its rim.
vec3 point_on(KERNEL_CONST_REF(GainTriangle) own, vec2 weights) {
  const vec2 front = max(weights, 0.0f);
  const vec2 inside = front / max(front.x + front.y, 1.0f);
  return own.corner + inside.x * own.edge_b + inside.y * own.edge_c;
}

/// A point of the triangle as visibility.h looks at it.
PlanePoint plane_point(uint triangle, KERNEL_CONST_REF(GainTriangle) own, vec3 at) {
  PlanePoint point;
  point.at = at;
  point.gradient = own.gradient;
  point.depth_bias = own.depth_bias;
  point.pixel_depth = own.pixel_depth;
  point.side_bit = own.side_bit;
  point.side = own.side;
  point.triangle = triangle;
  return point;
}

/// Each point is looked at in the one tile that its pixel belongs to.
bool is_of_tile(vec3 at) { return is_in_tile(ivec2(floor(vec2(at))) - tile_origin); }

/// What falls on the point with these weights; `most`: what would where it sees all of the sky.
uint point_gain(uint triangle, KERNEL_CONST_REF(GainTriangle) own, vec2 weights, vec2 windows, float most) {
  const vec3 at = point_on(own, weights);
  return is_of_tile(at) ? uint(most * seen_part(plane_point(triangle, own, at), windows) + 0.5f) : 0u;
}

/// What a fragment gains in this tile; `share`: of its triangle's area, `middle`: the weights at its centroid, `most`:
/// what it would gain where all of it sees the sky.
uint fragment_gain(uint triangle, float share, vec2 middle, KERNEL_CONST_REF(GainTriangle) own, float most) {
  KERNEL_CONST_REF(FragmentCells) cells =
      KERNEL_MEMOIZED(last_cells, uvec2(triangle, floatBitsToUint(share)), fragment_cells(own, share));
  const vec2 first = middle + cells.first;
  const float most_a_cell = most * cells.part;
  uint gain = 0u;
  for (int v = 0; v < cells.along_v; ++v) {
    for (int u = 0; u < cells.along_u; ++u) {
      gain += point_gain(triangle, own, first + float(u) * cells.step_u + float(v) * cells.step_v, cells.windows,
                         most_a_cell);
    }
  }
  return gain;
}

/// In which units a texel gains; `mixed`: parts of it face the fall with their front, parts with their back.
float gain_units(bool mixed) { return mixed ? kMixedUnits : kGainUnits; }

/// By how many bits what a fragment gains is shifted to where its side's sum lies; `back`: that is its triangle's back.
uint gain_shift(bool mixed, bool back) { return mixed && back ? kMixedBits : 0u; }

/// What a texel's gain says of the sides that it falls on.
uint gain_sides(bool mixed, bool faces_back) { return mixed ? kMixedSides : faces_back ? kBackSide : 0u; }

/// What falls on a smooth triangle where it sees all of the sky, as part of what lies across the fall; `front` and
/// `back`: what its smooth points hold there (smooth_points.h), `surface`: its own.
float smooth_facing(float front, float back, vec4 surface) {
  return front_part(surface_facing(surface)) * (shows_back(surface) ? back : front);
}
