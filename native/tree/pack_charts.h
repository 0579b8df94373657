#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace snowbough::tree {

/// The outline of a chart on the packing grid: column j is taken from cell begin[j] up to, not
/// including, end[j], counted from the chart's bottom.
struct PackShape {
  int width = 0;
  int height = 0;
  std::vector<int> begin;
  std::vector<int> end;
  /// Free cells it keeps on all sides: 1 or 2.
  int gutter = 1;
};

/// Where a chart lies: its lower left cell, and whether its columns and its rows are reversed.
struct Placement {
  int x = 0;
  int y = 0;
  bool columns_reversed = false;
  bool rows_reversed = false;
};

/// Packs charts onto a square grid, each as far to the left as it goes and there as far down as it
/// goes, in the given order, in whichever of the four orientations gets furthest left. Any two
/// charts stay as many cells apart, diagonals included, as the larger of their gutters; one cell
/// stays free along the border.
///
/// Of every column of the map the free runs are kept: the heights at which a chart fits are the
/// intersection of those at which each of its columns does.
/// @return one placement a shape, or nothing if they do not all fit.
std::optional<std::vector<Placement>> pack_charts(const std::vector<PackShape>& shapes, int grid);

}  // namespace snowbough::tree
