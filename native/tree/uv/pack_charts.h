#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace snowbough::tree {

/// Cells of one column of the packing grid from `begin` up to, not including, `end`.
struct CellRun {
  int begin = 0;
  int end = 0;

  bool operator==(const CellRun&) const = default;
};

/// The outline of a chart on the packing grid.
struct PackShape {
  int width = 0;
  int height = 0;
  /// Free cells on all sides: 1 or 2.
  int gutter = 1;
  /// Its first column in PackShapes::columns.
  size_t first_column = 0;
};

/// The outlines of all charts, in flat arrays.
struct PackShapes {
  std::vector<PackShape> shapes;
  /// The cells of each column of each chart, counted from the chart's bottom; none is empty.
  std::vector<CellRun> columns;

  std::span<const CellRun> columns_of(const PackShape& shape) const {
    return {columns.data() + shape.first_column, static_cast<size_t>(shape.width)};
  }
};

/// Position of a chart: its lower left cell, and whether its columns and rows are reversed.
struct Placement {
  int x = 0;
  int y = 0;
  bool columns_reversed = false;
  bool rows_reversed = false;
};

/// All charts on one grid.
struct Packing {
  /// One per shape.
  std::vector<Placement> placements;
  /// Columns of the grid in use, including the free ones along both borders.
  int used_columns = 0;
};

/// Packs charts onto a grid of `rows` by `columns` cells, the highest first, each as far left as
/// possible and there as far down as possible, in the one of four orientations that gets furthest
/// left. Any two charts are separated by as many cells, diagonally too, as the larger of their
/// gutters; one cell stays free along the border. Charts of equal height are packed in the order of
/// their outlines, equal outlines in input order.
///
/// For every column of the grid the free runs are kept: a chart fits at the heights at which each
/// of its columns fits.
/// @param rows, columns  at most 16384 each.
/// @return no value if they do not all fit.
std::optional<Packing> pack_charts(const PackShapes& shapes, int rows, int columns);

}  // namespace snowbough::tree
