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
  /// Row r's sum over `values`; 0 where it has no terms.
  float sum(size_t r, const std::vector<float>& values) const {
    float result = 0.0f;
    for (int32_t t = begin[r]; t < begin[r + 1]; ++t) result += weight[t] * values[source[t]];
    return result;
  }
};

/// How far a filter may reach along a line, in texels.
inline constexpr int32_t kFilterReach = 4;
/// How far the output is continued beyond the charts, in texels.
inline constexpr int32_t kDilation = 4;

/// A map's texels laid out in lines along one axis, for filters that know no charts. A run (texels
/// of one chart that lie side by side) takes kFilterReach + length + kFilterReach places; the outer
/// ones are ghosts: what one meets who goes straight on over the surface, across seams. Where
/// the surface ends, a ghost has no terms and its place holds kNothing.
struct TexelLines {
  /// Per owned texel: its place in the line array.
  std::vector<int32_t> place;
  int32_t length = 0;
  /// Per ghost: its place and the texels it takes its value from (indices into TexelTable's arrays;
  /// weights sum to 1).
  std::vector<int32_t> ghost_place;
  WeightedRows ghosts;
};

/// Value of a place without surface; a height is over kSomething, below 0 on a surface's back.
inline constexpr float kNothing = -1e30f;
inline constexpr float kSomething = -1e29f;

/// How a map's texels hang together over the surface, across the seams of its layout.
struct SeamTable {
  /// Lines along u (rows) and along v (columns).
  TexelLines u;
  TexelLines v;
  /// Texels that nobody owns, within kDilation of one that is: linear index, ascending, and what
  /// they show: the surface beyond the seam, or the nearest texel where it ends.
  std::vector<int32_t> dilated;
  WeightedRows dilated_rows;
  /// Per dilated texel: the owned texel nearest to it (index into TexelTable's arrays), for values
  /// such as tangent-space normals that mean something else beyond the seam.
  std::vector<int32_t> dilated_nearest;
  SeamLevelling levelling;
  /// Per owned texel: how long a step of one texel along u and along v is on the surface, metres.
  std::vector<glm::vec2> texel_size;
  /// Per owned texel: the area that it covers, m2.
  std::vector<float> texel_area;
};

/// Builds the table for a layout in the pose `positions` (vertex_count points, metres). Built once;
/// deformation later on changes little about which texel lies beside which.
/// @throws std::invalid_argument when the number of positions is not topology.vertex_count.
SeamTable build_seam_table(const MapTopology& topology, const TexelTable& table,
                           const std::vector<glm::vec3>& positions);

/// Fills a line array of lines.length places from one value an owned texel, ghosts included.
void fill_lines(const TexelLines& lines, const std::vector<float>& values,
                std::vector<float>& line);

}  // namespace snowbough::snow
