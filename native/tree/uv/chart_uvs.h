#pragma once

#include "tree/skeleton/tree_mesh.h"
#include "tree/uv/chart_shape.h"
#include "tree/uv/pack_charts.h"
#include "tree/uv/strip_rows.h"

namespace snowbough::tree {

/// The map and the packing grid of the charts.
struct ChartMap {
  /// Texels along one side of the map.
  int resolution = 0;
  /// Texels along one side of a cell of the packing grid.
  int cell_size = 1;
};

/// Writes one chart's part of `uv_snow`, cut open along corner `seam`: walls, insets in their
/// knuckle's cell around its hole, and caps at the strip's ends, along the straight edge.
/// @param mesh  uv_snow with one entry per quad; only those of the chart are written.
void write_chart_uvs(const Strip& strip, const ChartShapes& shapes, const ChartShape& chart,
                     int32_t seam, const PackShape& outline, const Placement& placement,
                     const ChartMap& map, TreeMesh& mesh);

}  // namespace snowbough::tree
