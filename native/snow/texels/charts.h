#pragma once

#include <cstdint>
#include <vector>

#include "snow/texels/texel_table.h"

namespace snowbough::snow {

/// A triangle's edge: edge k runs from corner k to corner (k + 1) % 3.
struct TriangleEdge {
  int32_t triangle = -1;
  int32_t edge = 0;
};

/// Two triangle edges that are one edge of the mesh but not of the layout: the surface continues
/// across it, the UVs do not. Corner k of `a` meets corner k + 1 of `b` if `same_direction` is
/// false (the usual case, neighbours with one winding), else corner k.
struct Seam {
  TriangleEdge a;
  TriangleEdge b;
  bool same_direction = false;
};

struct Charts {
  /// Per triangle: its chart, numbered by their first triangles.
  std::vector<int32_t> chart;
  int32_t count = 0;
  std::vector<Seam> seams;
  /// Edges without a neighbour, or with several, where the surface ends or branches: nothing is
  /// carried across.
  std::vector<TriangleEdge> open_edges;
};

/// Finds the charts of a layout: triangles that share two vertex indices with equal UVs (within
/// 1e-6) are in one chart; sharing only the vertices makes a seam. O(T log T). `topology` must have
/// passed build_texel_table's checks.
Charts find_charts(const MapTopology& topology);

}  // namespace snowbough::snow
