#pragma once

// The deposit of one texel, by gathering: every fragment that faces the fall gains the snow that falls on it, times its
// visible part. No texels share snow and no sum is kept per pixel, so that an evenly lit surface is evenly covered for
// all sizes of texels and pixels. All snow of a texel lies on one side; at a fold whose both sides face the fall, the
// side is decided after all tiles.
#include "facing.h"
#include "projection_frame.h"
#include "kernel.h"
#include "texel_surface.h"
#include "visibility.h"

/// A MapTriangle as two vectors.
KERNEL_VIEW_RGBA32F(map_triangles);
/// Texels per side of the map.
KERNEL_UNIFORM(float, resolution);

/// Maximum size in pixels of a fragment's sample cells, and maximum number of cells per side: larger fragments have
/// larger cells, in which each step samples another position.
KERNEL_CONSTANT float kCellPixels = 1.5f;
KERNEL_CONSTANT int kMaxCells = 8;
KERNEL_CONSTANT float kMinWindow = 1e-3f;

/// A triangle on the grid (pixels, metres of depth) and on its map.
struct GainTriangle {
  vec3 corner;
  vec3 edge_b;
  vec3 edge_c;
  /// One texel along u and along v, in weights of the second and third corner.
  vec2 along_u;
  vec2 along_v;
  vec2 gradient;
  float depth_bias;
  float pixel_depth;
  /// As in a PlanePoint.
  uint side_bit;
  uint side;
  /// Number of texels that it covers.
  float texels;
};

/// `map_triangle`: its index in map_triangles.
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

/// The sample cells of a fragment, with one sample each. The same for all fragments with the same share of a triangle.
struct FragmentCells {
  int along_u;
  int along_v;
  /// Offset from the fragment's centroid to the first sample, and between cells, in weights of the triangle's second
  /// and third corner.
  vec2 first;
  vec2 step_u;
  vec2 step_v;
  /// Number of windows in a pixel's width and height.
  vec2 windows;
  /// Part of the fragment in each cell.
  float part;
};

/// Number of cells along one side of a fragment that is `extent` pixels long.
int cell_count(vec2 extent) {
  return clamp(int(ceil(max(abs(extent.x), abs(extent.y)) / kCellPixels)), 1, kMaxCells);
}

/// Position of a sample in its cell, 0 to 1.
float place_in_cell(vec2 extent, int cells, float shift) {
  return max(abs(extent.x), abs(extent.y)) > kCellPixels * float(cells) ? shift : 0.5f;
}

/// Extent of weights on the grid, in pixels.
vec2 extent_of(KERNEL_CONST_REF(GainTriangle) own, vec2 weights) {
  return weights.x * vec2(own.edge_b) + weights.y * vec2(own.edge_c);
}

/// A fragment is sampled as a square of its area within a texel: its side in texels.
float fragment_side(KERNEL_CONST_REF(GainTriangle) own, float share) { return sqrt(min(1.0f, share * own.texels)); }

/// Number of windows in a pixel's width and height, for cells of these sides: each window is half of the cell. The rest
/// of the cell sees the same pixels or adjacent ones.
vec2 windows_of(vec2 cell_u, vec2 cell_v) {
  return 1.0f / clamp(0.5f * (abs(cell_u) + abs(cell_v)), kMinWindow, 1.0f);
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

/// The point of a triangle at these weights of its second and third corner, clamped to the triangle.
vec3 point_on(KERNEL_CONST_REF(GainTriangle) own, vec2 weights) {
  const vec2 positive = max(weights, 0.0f);
  const vec2 inside = positive / max(positive.x + positive.y, 1.0f);
  return own.corner + inside.x * own.edge_b + inside.y * own.edge_c;
}

/// A point of the triangle as input of visibility.h.
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

/// Whether this tile evaluates the point: the one that contains its pixel.
bool is_of_tile(vec3 at) { return is_in_tile(ivec2(floor(vec2(at))) - tile_origin); }

/// The gain of the point at these weights; `most`: its gain under open sky.
uint point_gain(uint triangle, KERNEL_CONST_REF(GainTriangle) own, vec2 weights, vec2 windows, float most) {
  const vec3 at = point_on(own, weights);
  return is_of_tile(at) ? uint(most * seen_part(plane_point(triangle, own, at), windows) + 0.5f) : 0u;
}

/// A fragment's gain in this tile; `share`: of its triangle's area, `middle`: the weights at its centroid, `most`: its
/// gain under open sky.
uint fragment_gain(uint triangle, float share, vec2 middle, KERNEL_CONST_REF(GainTriangle) own, float most) {
  const FragmentCells cells = fragment_cells(own, share);
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

/// Units of a texel's gain; `mixed`: some of its parts face the fall with their positive side, others with their back.
float gain_units(bool mixed) { return mixed ? kMixedUnits : kGainUnits; }

/// Shift of a fragment's gain to its side's sum; `back`: its triangle faces the fall with its back.
uint gain_shift(bool mixed, bool back) { return mixed && back ? kMixedBits : 0u; }

/// The flags of a texel's gain for its sides.
uint gain_sides(bool mixed, bool faces_back) { return mixed ? kMixedSides : faces_back ? kBackSide : 0u; }

/// Gain of a smooth triangle under open sky, relative to the thickness perpendicular to the fall; `positive` and `back`:
/// interpolated from its smooth points (smooth_points.h), `surface`: its own.
float smooth_facing(float positive, float back, vec4 surface) {
  return facing_part(surface_facing(surface)) * (shows_back(surface) ? back : positive);
}
