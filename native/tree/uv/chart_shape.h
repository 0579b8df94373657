#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "tree/uv/pack_charts.h"
#include "tree/uv/strip_pieces.h"
#include "tree/uv/strip_rows.h"

namespace snowbough::tree {

/// Height of a ring in its chart and width of the chart there, in texels.
struct ChartRing {
  double y = 0.0;
  double width = 0.0;
};

/// A piece of a strip unrolled flat, in texels, standing on y = 0 with one straight vertical edge.
struct ChartShape {
  StripPiece piece;
  /// Its first ring in ChartShapes::rings; one more than the piece has rows.
  size_t first_ring = 0;
  /// Sides of the squares that close root and tip, 0 if there is none.
  double root_cap = 0.0;
  double tip_cap = 0.0;
  /// Extent of the whole chart.
  double width = 0.0;
  double height = 0.0;
};

/// The shapes of all charts, in flat arrays.
struct ChartShapes {
  std::vector<ChartShape> charts;
  std::vector<ChartRing> rings;

  std::span<const ChartRing> rings_of(const ChartShape& chart) const {
    return {rings.data() + chart.first_ring,
            static_cast<size_t>(chart.piece.last_row - chart.piece.first_row + 1)};
  }
};

/// Narrowest chart in texels.
inline constexpr double kMinChartWidth = 2.0;
/// A chart wider than this keeps two free texels around it, others one.
inline constexpr double kWideChart = 4.0;

/// Factor by which a chart widened from `own_width` to `width` texels is shortened: as little as
/// needed to keep its texels per m2 near the rest's, and to a tenth at most.
double shortening(double own_width, double width);

/// Length in texels of each row of a strip at `scale` texels per metre: long enough for the row's
/// share of texels, except where it was widened to two texels.
void row_lengths(const Strip& strip, double scale, std::vector<double>& lengths);

/// Adds the shape of a piece to the charts.
/// @param lengths     row_lengths of the whole strip.
/// @param max_height  a chart of one long row is shortened to this height.
void add_chart(const Strip& strip, const StripPiece& piece, const std::vector<double>& lengths,
               double scale, double max_height, ChartShapes& shapes);

/// Adds the cells of the packing grid that a chart touches, with its straight edge on the left.
/// @param cell_size  texels per side of a cell of the packing grid.
void add_footprint(const ChartShapes& shapes, const ChartShape& chart, const Strip& strip,
                   int cell_size, PackShapes& outlines);

/// Positions of a ring's five corners (the seam's twice) across the chart, from 0 to 1.
std::array<double, 5> column_shares(const StripRing& ring, int seam);

}  // namespace snowbough::tree
