#pragma once

#include <cstdint>
#include <vector>

#include "snow/seams/least_squares.h"
#include "snow/texels/charts.h"
#include "snow/texels/texel_table.h"

namespace snowbough::snow {

/// What is left between the two sides of a seam after smoothing comes from interpolation: a side
/// reads the map between texels that lie elsewhere than the other side's. Levelling takes it out
/// (see seam_leveller.h); these are the points along every seam, four a texel, at which it looks.
struct SeamLevelling {
  /// Every texel that a point looks at, by its linear index in the map: first those that may
  /// change, ascending, then, ascending too, those that a side reads although they are another
  /// chart's.
  std::vector<int32_t> texel;
  int32_t unknowns = 0;
  /// Per point: the second side's height less the first's; sources are indices into `texel`, and
  /// texel.size() where a point has fewer terms.
  std::vector<SeamRow> points;
  /// Snow thinner than this (metres) may differ by as much as snow of this height: a fortieth of a
  /// texel.
  float least_height = 0.0f;
};

/// `owned`: per texel of the map its index in the table, or -1. `texel_size`: of a texel in the
/// mean, metres.
SeamLevelling find_seam_gaps(const MapTopology& topology, const TexelTable& table,
                             const Charts& charts, const std::vector<int32_t>& owned,
                             float texel_size);

}  // namespace snowbough::snow
