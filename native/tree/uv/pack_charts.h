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
  /// Free cells it keeps on all sides: 1 or 2.
  int gutter = 1;
  /// Its left column in PackShapes::columns.
  size_t first_column = 0;
};

/// The outlines of all charts, in flat arrays.
struct PackShapes {
  std::vector<PackShape> shapes;
  /// The cells that each column of each chart takes, counted from the chart's bottom; none empty.
  std::vector<CellRun> columns;

  std::span<const CellRun> columns_of(const PackShape& shape) const {
    return {columns.data() + shape.first_column, static_cast<size_t>(shape.width)};
  }
};

/// Where a chart lies: its lower left cell, and whether its columns and its rows are reversed.
struct Placement {
  int x = 0;
  int y = 0;
  bool columns_reversed = false;
  bool rows_reversed = false;
};

/// All charts on one grid.
struct Packing {
  /// One a shape.
  std::vector<Placement> placements;
  /// Columns of the grid that it takes, the free ones along both borders included.
  int used_columns = 0;
};

/// Packs charts onto a grid of `rows` by `columns` cells, the highest first, each as far to the
/// left as it goes and there as far down as it goes, in whichever of the four orientations gets
/// furthest left. Any two charts stay as many cells apart, diagonals included, as the larger of
/// their gutters; one cell stays free along the border. Charts that are the same high are packed in
/// the order of their outlines, equal ones in their own.
///
/// Of every column of the grid the free runs are kept: the heights at which a chart fits are those
/// at which each of its columns does.
/// @param rows, columns  at most 16384 each.
/// @return nothing if they do not all fit.
std::optional<Packing> pack_charts(const PackShapes& shapes, int rows, int columns);

}  // namespace snowbough::tree
