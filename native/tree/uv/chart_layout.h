#pragma once

#include <optional>
#include <vector>

#include "base/parallel_for.h"
#include "tree/uv/chart_shape.h"
#include "tree/uv/chart_uvs.h"
#include "tree/uv/pack_charts.h"
#include "tree/uv/strip_rows.h"

namespace snowbough::tree {

/// All charts at one scale and their places on the packing grid.
struct ChartLayout {
  ChartMap map;
  ChartShapes shapes;
  PackShapes outlines;
  Packing packing;
};

/// Lays the strips out as charts on a map of `resolution` squared texels, at nearly the largest
/// scale at which all of them fit.
///
/// The filled fraction of the grid hardly depends on the scale. Each attempt packs onto a grid with
/// spare columns and derives the next scale from the number of columns used; two or three attempts
/// come within a hundredth of the map's width. Maps of more than 2048 texels are packed in cells of
/// several texels, with the same fill.
/// @return no value if even charts of the smallest size do not fit.
/// @throws Cancelled when execution's progress says stop.
std::optional<ChartLayout> lay_out_charts(const std::vector<Strip>& strips, int resolution,
                                          const base::Execution& execution);

}  // namespace snowbough::tree
