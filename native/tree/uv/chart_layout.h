#pragma once

#include <optional>
#include <vector>

#include "base/parallel_for.h"
#include "tree/uv/chart_shape.h"
#include "tree/uv/chart_uvs.h"
#include "tree/uv/pack_charts.h"
#include "tree/uv/strip_rows.h"

namespace snowbough::tree {

/// All charts at one scale and where they lie on the packing grid.
struct ChartLayout {
  ChartMap map;
  ChartShapes shapes;
  PackShapes outlines;
  Packing packing;
};

/// Lays the strips out as charts on a map of `resolution` squared texels, at nearly the largest
/// scale at which all of them fit.
///
/// How much of the grid charts fill hardly depends on the scale. So each attempt packs them onto a
/// grid with columns to spare and takes the next scale from the number of columns that it took; two
/// or three attempts come within a hundredth of the map's width. Maps of more than 2048 texels are
/// packed in cells of several texels, to the same fill.
/// @return nothing if not even charts of the smallest size fit.
/// @throws Cancelled when execution's progress says stop.
std::optional<ChartLayout> lay_out_charts(const std::vector<Strip>& strips, int resolution,
                                          const base::Execution& execution);

}  // namespace snowbough::tree
