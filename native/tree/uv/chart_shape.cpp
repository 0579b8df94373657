#include "tree/uv/chart_shape.h"

#include <algorithm>

namespace snowbough::tree {
namespace {

/// Maximum factor by which a widened row exceeds its share of texels, which determines its
/// shortening. Rounding limbs and blending forks spread a detailed surface's texel density by
/// another third, and the total from its 5th to its 95th percentile is limited to a factor of two.
constexpr double kMaxDensityRatio = 1.5;
/// Twigs of a fifth of a texel in width keep kMaxDensityRatio; thinner ones get more texels.
constexpr double kMinShortening = 0.1;
/// Minimum length in texels of rows of zero length (coincident rings), for a positive area.
constexpr double kMinRowLength = 1.0 / 32.0;
/// Minimum fraction of the perimeter for a side in the map.
constexpr double kMinSideShare = 0.1;
/// Tolerance, in cells, for outlines that pass a cell's edge.
constexpr double kCellTolerance = 1e-6;

double ring_width(double perimeter, double scale) {
  return std::max(kMinChartWidth, scale * perimeter);
}

/// Width of a ring's broadest side: the maximum width of a cap on any side.
double cap_width(const StripRing& ring, double ring_width) {
  const auto columns = column_shares(ring, 0);
  double widest = 0.0;
  for (int side = 0; side < kStripSides; ++side) {
    widest = std::max(widest, columns[side + 1] - columns[side]);
  }
  return ring_width * widest;
}

int cell_at(double at) {
  return static_cast<int>(at + kCellTolerance);
}

/// First cell above `at`, which is not negative.
int cell_after(double at) {
  const int cell = static_cast<int>(at - kCellTolerance);
  return cell < at - kCellTolerance ? cell + 1 : cell;
}

/// The slanted edge of a chart, from one end to the other, in cells: the chart's part of a column
/// begins where the edge first passes the column's left side.
class SlantedEdge {
 public:
  /// The edge begins at its first point. `meet(column, y)` is called once for each column that the
  /// edge enters, in order.
  template <typename Meet>
  void go_on(const ChartRing& point, const Meet& meet) {
    const ChartRing from = begun_ ? at_ : point;
    const int columns = cell_after(point.width);
    for (; columns_ < columns; ++columns_) {
      const bool crosses = from.width < columns_;
      meet(columns_, crosses ? from.y + (point.y - from.y) * (columns_ - from.width) /
                                            (point.width - from.width)
                             : from.y);
    }
    at_ = point;
    begun_ = true;
  }

 private:
  ChartRing at_;
  bool begun_ = false;
  /// Number of columns visited.
  int columns_ = 0;
};

}  // namespace

std::array<double, 5> column_shares(const StripRing& ring, int seam) {
  const double perimeter = double{ring.sides[0]} + ring.sides[1] + ring.sides[2] + ring.sides[3];
  const double least = perimeter > 0.0 ? kMinSideShare * perimeter : 1.0;
  std::array<double, kStripSides> share{};
  double sum = 0.0;
  for (int column = 0; column < kStripSides; ++column) {
    share[column] = std::max<double>(ring.sides[(seam + column) % kStripSides], least);
    sum += share[column];
  }
  const double scale = 1.0 / sum;
  std::array<double, kStripSides + 1> columns{};
  for (int column = 0; column < kStripSides; ++column) {
    columns[column + 1] = columns[column] + share[column] * scale;
  }
  columns[kStripSides] = 1.0;
  return columns;
}

double shortening(double own_width, double width) {
  return std::clamp(kMaxDensityRatio * own_width / width, kMinShortening, 1.0);
}

void row_lengths(const Strip& strip, double scale, std::vector<double>& lengths) {
  lengths.resize(strip.areas.size());
  for (size_t row = 0; row < lengths.size(); ++row) {
    const double bottom = strip.perimeters[row];
    const double top = strip.perimeters[row + 1];
    const double own_width = 0.5 * scale * (bottom + top);
    const double width = 0.5 * (ring_width(bottom, scale) + ring_width(top, scale));
    double length = own_width > 0.0 ? scale * scale * strip.areas[row] / own_width : 0.0;
    if (width > own_width) {
      length *= shortening(own_width, width);
    }
    lengths[row] = std::max(length, kMinRowLength);
  }
}

void add_chart(const Strip& strip, const StripPiece& piece, const std::vector<double>& lengths,
               double scale, double max_height, ChartShapes& shapes) {
  ChartShape chart;
  chart.piece = piece;
  chart.first_ring = shapes.rings.size();
  double walls = 0.0;
  for (int32_t row = piece.first_row; row < piece.last_row; ++row) {
    walls += lengths[row];
  }
  const double first_width = ring_width(strip.perimeters[piece.first_row], scale);
  const double last_width = ring_width(strip.perimeters[piece.last_row], scale);
  chart.root_cap = piece.has_root_cap ? 0.25 * first_width : 0.0;
  chart.tip_cap = piece.has_tip_cap ? 0.25 * last_width : 0.0;
  const double caps = chart.root_cap + chart.tip_cap;
  const double stretch =
      std::clamp(walls, kMinChartWidth, std::max(max_height - caps, kMinChartWidth)) / walls;
  double y = chart.root_cap;
  for (int32_t row = piece.first_row; row < piece.last_row; ++row) {
    const double width = ring_width(strip.perimeters[row], scale);
    chart.width = std::max(chart.width, width);
    shapes.rings.push_back({y, width});
    y += stretch * lengths[row];
  }
  chart.width = std::max(chart.width, last_width);
  shapes.rings.push_back({y, last_width});
  chart.height = y + chart.tip_cap;
  shapes.charts.push_back(chart);
}

void add_footprint(const ChartShapes& shapes, const ChartShape& chart, const Strip& strip,
                   int cell_size, PackShapes& outlines) {
  const double to_cells = 1.0 / cell_size;
  PackShape outline;
  outline.width = cell_after(chart.width * to_cells);
  outline.height = cell_after(chart.height * to_cells);
  outline.first_column = outlines.columns.size();
  const int gutter = chart.width > kWideChart ? 2 : 1;
  outline.gutter = (gutter + cell_size - 1) / cell_size;
  outlines.shapes.push_back(outline);
  outlines.columns.resize(outline.first_column + outline.width);
  CellRun* const columns = outlines.columns.data() + outline.first_column;

  const std::span<const ChartRing> rings = shapes.rings_of(chart);
  const StripPiece& piece = chart.piece;
  const auto in_cells = [to_cells](double y, double width) {
    return ChartRing{y * to_cells, width * to_cells};
  };
  // Caps are squares on the ends, never wider than these.
  SlantedEdge up;
  const auto begin_column = [columns](int column, double y) { columns[column].begin = cell_at(y); };
  if (chart.root_cap > 0.0) {
    const double width = cap_width(strip.rings[piece.first_row], rings.front().width);
    up.go_on(in_cells(0.0, width), begin_column);
    up.go_on(in_cells(chart.root_cap, width), begin_column);
  }
  for (const ChartRing& ring : rings) {
    up.go_on(in_cells(ring.y, ring.width), begin_column);
  }
  SlantedEdge down;
  const auto end_column = [columns](int column, double y) {
    // A nearly empty column still takes a cell.
    columns[column].end = std::max(cell_after(y), columns[column].begin + 1);
  };
  if (chart.tip_cap > 0.0) {
    const double width = cap_width(strip.rings[piece.last_row], rings.back().width);
    down.go_on(in_cells(chart.height, width), end_column);
    down.go_on(in_cells(rings.back().y, width), end_column);
  }
  for (size_t i = rings.size(); i-- > 0;) {
    down.go_on(in_cells(rings[i].y, rings[i].width), end_column);
  }
}

}  // namespace snowbough::tree
