#pragma once

#include <glm/vec2.hpp>
#include <vector>

#include "tree/pack_charts.h"
#include "tree/strip_rows.h"

namespace snowbough::tree {

/// A piece of a strip unrolled flat, in texels, standing on y = 0 with one straight vertical edge.
struct ChartShape {
  StripPiece piece;
  /// Height of each ring of the piece and width of the chart there; one more than the piece's rows.
  std::vector<double> ring_y;
  std::vector<double> ring_width;
  /// Sides of the squares that close root and tip, 0 where there is none.
  double root_cap = 0.0;
  double tip_cap = 0.0;
  /// Extent of the whole chart.
  double width = 0.0;
  double height = 0.0;
};

/// Length in texels of each row of a strip at `scale` texels a metre: as long as it takes to give
/// the row its share of texels, but where it had to be widened to two texels.
std::vector<double> row_lengths(const Strip& strip, double scale);

/// @param lengths     row_lengths of the whole strip.
/// @param max_height  a chart of one long row is shortened to this height.
ChartShape shape_chart(const Strip& strip, const StripPiece& piece,
                       const std::vector<double>& lengths, double scale, double max_height);

/// The cells of the packing grid that the chart touches, its straight edge on the left.
/// @param cell_size  texels along one side of a cell of the packing grid.
PackShape footprint(const ChartShape& shape, const Strip& strip, int cell_size);

/// Writes the chart's part of `uv_snow`, cut open along corner `seam`.
/// @param resolution  texels along one side of the map.
void write_chart_uvs(TreeMesh& mesh, const Strip& strip, const ChartShape& shape, int32_t seam,
                     const PackShape& outline, const Placement& placement, int resolution,
                     int cell_size);

}  // namespace snowbough::tree
