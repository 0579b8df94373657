#pragma once

#include <cstdint>
#include <vector>

#include "snow/seams/seam_row.h"
#include "snow/texels/charts.h"
#include "snow/texels/texel_table.h"

namespace snowbough::snow {

/// Sample points along every seam, four per texel, for levelling (see seam_leveller.h). Each side
/// of a seam interpolates between differently placed texels, so that the sides differ slightly even
/// after smoothing.
struct SeamLevelling {
  /// Linear map indices of all texels that a point reads: first those that may change, ascending;
  /// then, also ascending, those that a side reads although another chart owns them.
  std::vector<int32_t> texel;
  int32_t unknowns = 0;
  /// Per point: the second side's height minus the first's; sources are indices into `texel`, or
  /// texel.size() for unused terms.
  std::vector<SeamRow> points;
  /// Snow thinner than this (metres) is allowed the difference of snow of this height: a fortieth
  /// of a texel, but over 0.
  float least_height = 0.0f;
};

/// `owned`: per texel of the map its index in the table, or -1. `texel_size`: mean size of a texel,
/// metres.
SeamLevelling find_seam_gaps(const MapTopology& topology, const TexelTable& table,
                             const Charts& charts, const std::vector<int32_t>& owned,
                             float texel_size);

}  // namespace snowbough::snow
