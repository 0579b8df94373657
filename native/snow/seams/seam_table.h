#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "snow/seams/seam_samples.h"
#include "snow/texels/texel_table.h"

namespace snowbough::snow {

/// A list of weighted sums. Row r has the terms [begin[r], begin[r + 1]).
struct WeightedRows {
  std::vector<int32_t> begin{0};
  std::vector<int32_t> source;
  std::vector<float> weight;

  size_t size() const { return begin.size() - 1; }
  /// Row r's sum over `values`; 0 for a row without terms.
  float sum(size_t r, const std::vector<float>& values) const {
    float result = 0.0f;
    for (int32_t t = begin[r]; t < begin[r + 1]; ++t) result += weight[t] * values[source[t]];
    return result;
  }
};

/// Reach of a filter along a line, in texels.
inline constexpr int32_t kFilterReach = 4;
/// Width of the output's extension beyond the charts, in texels.
inline constexpr int32_t kDilation = 4;

/// A map's texels as lines along one axis, for filters that know no charts. A run (consecutive
/// texels of one chart) takes kFilterReach + length + kFilterReach places; the outer ones are
/// ghosts: the surface straight ahead, across seams. Where the surface ends, a ghost has no terms
/// and its place holds kNothing.
struct TexelLines {
  /// Per owned texel: its place in the line array.
  std::vector<int32_t> place;
  int32_t length = 0;
  /// Per ghost: its place and the texels that it interpolates (indices into TexelTable's arrays;
  /// weights sum to 1).
  std::vector<int32_t> ghost_place;
  WeightedRows ghosts;
};

/// Value of a place without surface; heights are above kSomething, and negative on a surface's
/// back.
inline constexpr float kNothing = -1e30f;
inline constexpr float kSomething = -1e29f;

/// Connectivity of a map's texels over the surface, across the seams of its layout.
struct SeamTable {
  /// Lines along u (rows) and along v (columns).
  TexelLines u;
  TexelLines v;
  /// Texels without owner within kDilation of an owned one: linear index, ascending, and their
  /// value: the surface beyond the seam, or the nearest texel where the surface ends.
  std::vector<int32_t> dilated;
  WeightedRows dilated_rows;
  /// Per dilated texel: the nearest owned texel (index into TexelTable's arrays), for values such
  /// as tangent-space normals that do not carry over a seam.
  std::vector<int32_t> dilated_nearest;
  SeamLevelling levelling;
  /// Per owned texel: length in metres on the surface of one texel along u and along v.
  std::vector<glm::vec2> texel_size;
  /// Per owned texel: its area, m2.
  std::vector<float> texel_area;
};

/// Builds the table for a layout in the pose `positions` (vertex_count points, metres). Built once:
/// deformation hardly changes which texels are adjacent.
/// @throws std::invalid_argument if the number of positions is not topology.vertex_count.
SeamTable build_seam_table(const MapTopology& topology, const TexelTable& table,
                           const std::vector<glm::vec3>& positions);

/// Fills a line array of lines.length places from one value per owned texel, ghosts included.
void fill_lines(const TexelLines& lines, const std::vector<float>& values,
                std::vector<float>& line);

}  // namespace snowbough::snow
