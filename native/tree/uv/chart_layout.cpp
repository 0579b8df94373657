#include "tree/uv/chart_layout.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace snowbough::tree {
namespace {

/// Finest packing grid.
constexpr int kMaxGrid = 2048;
/// A row longer than the map may be shortened to this fraction; beyond, the scale is reduced.
constexpr double kMinSqueeze = 2.0 / 3.0;
/// At this fraction of the largest scale all charts have their minimum size.
constexpr double kTinyScale = 1e-9;
/// Width of the packing grid relative to the map: an excess can then be measured.
constexpr double kSpareColumns = 1.3;
/// Assumed ratio of expected cells to those of the columns used, before the first packing.
constexpr double kUsualFill = 0.88;
/// Target below 1, since the columns used vary by about half a hundredth.
constexpr double kAim = 0.995;
/// Fraction of the map's columns that is good enough.
constexpr double kGoodUse = 0.985;
constexpr int kMaxAttempts = 10;
/// If an attempt's columns give no estimate: the factor to the next scale, and the ratio between
/// failing and fitting scales at which the search ends.
constexpr double kStepDown = 0.95;
constexpr double kCloseScales = 1.005;

/// Size of a strip for estimating its chart, in metres.
struct StripSize {
  double area = 0.0;
  double length = 0.0;
  double widest = 0.0;
};

/// Estimates the cells of all charts with one side of their gutters. Off by a factor that hardly
/// depends on the scale.
class Demand {
 public:
  Demand(const std::vector<Strip>& strips, int cell_size) : cell_size_(cell_size) {
    sizes_.reserve(strips.size());
    for (const Strip& strip : strips) {
      StripSize& size = sizes_.emplace_back();
      for (size_t row = 0; row < strip.areas.size(); ++row) {
        const double width = 0.5 * (strip.perimeters[row] + strip.perimeters[row + 1]);
        const double length = width > 0.0 ? strip.areas[row] / width : 0.0;
        size.area += strip.areas[row];
        size.length += length;
        size.widest = std::max(size.widest, width);
        longest_row_ = std::max(longest_row_, length);
        widest_row_ = std::max(widest_row_, width);
      }
    }
  }

  /// In metres.
  double longest_row() const { return longest_row_; }
  double widest_row() const { return widest_row_; }

  double cells_at(double scale) const {
    double cells = 0.0;
    for (const StripSize& size : sizes_) {
      const double own_width = size.length > 0.0 ? scale * size.area / size.length : 0.0;
      const double width = std::max(own_width, kMinChartWidth);
      const double height =
          std::max(scale * size.length * shortening(own_width, width), kMinChartWidth);
      const double gutter = std::ceil((scale * size.widest > kWideChart ? 2.0 : 1.0) / cell_size_);
      // Half a cell is lost along the slanted edge, one at the ends.
      cells += (width / cell_size_ + 0.5 + gutter) * (height / cell_size_ + 1.0 + gutter);
    }
    return cells;
  }

  /// Scale up to `largest` at which the charts take this many cells; 0 if they take more at any
  /// scale.
  double scale_for(double cells, double largest) const {
    double low = 0.0;
    double high = largest;
    for (int step = 0; step < 30; ++step) {
      const double middle = 0.5 * (low + high);
      (cells_at(middle) > cells ? high : low) = middle;
    }
    return low;
  }

 private:
  int cell_size_;
  std::vector<StripSize> sizes_;
  double longest_row_ = 0.0;
  double widest_row_ = 0.0;
};

/// Scale at which the longest single row still fits the map's height.
double largest_scale(const Demand& demand, int resolution) {
  const double room = resolution - 4.0;
  return std::min(room / std::max(kMinSqueeze * demand.longest_row(), 1e-30),
                  0.9 * room / std::max(demand.widest_row(), 1e-30));
}

/// Shapes all strips at one scale. Reuses its vectors.
class Shaper {
 public:
  Shaper(const std::vector<Strip>& strips, const ChartMap& map) : strips_(strips), map_(map) {}

  void shape(double scale, ChartLayout& layout) {
    // In whole cells.
    const int32_t rows = map_.resolution / map_.cell_size;
    const double max_height = static_cast<double>(rows - 2) * map_.cell_size;
    layout.map = map_;
    layout.shapes.charts.clear();
    layout.shapes.rings.clear();
    layout.outlines.shapes.clear();
    layout.outlines.columns.clear();
    for (size_t i = 0; i < strips_.size(); ++i) {
      const Strip& strip = strips_[i];
      row_lengths(strip, scale, lengths_);
      const double caps = 0.25 * scale *
                          ((strip.root_cap >= 0 ? strip.perimeters.front() : 0.0) +
                           (strip.tip_cap >= 0 ? strip.perimeters.back() : 0.0));
      const double max_length = std::max(max_height - caps - 1.0, 0.25 * max_height);
      pieces_.clear();
      cut_strip(strip, static_cast<int32_t>(i), lengths_, max_length, pieces_);
      for (const StripPiece& piece : pieces_) {
        add_chart(strip, piece, lengths_, scale, max_height, layout.shapes);
        add_footprint(layout.shapes, layout.shapes.charts.back(), strip, map_.cell_size,
                      layout.outlines);
      }
    }
  }

 private:
  const std::vector<Strip>& strips_;
  ChartMap map_;
  std::vector<double> lengths_;
  std::vector<StripPiece> pieces_;
};

}  // namespace

std::optional<ChartLayout> lay_out_charts(const std::vector<Strip>& strips, int resolution,
                                          const base::Execution& execution) {
  const int cell_size = (resolution + kMaxGrid - 1) / kMaxGrid;
  const int grid = resolution / cell_size;
  const double cells = static_cast<double>(grid) * grid;
  const Demand demand(strips, cell_size);
  Shaper shaper(strips, {resolution, cell_size});
  const double largest = largest_scale(demand, resolution);
  const double tiny = kTinyScale * largest;
  const int columns = static_cast<int>(kSpareColumns * grid);
  std::optional<ChartLayout> best;
  ChartLayout layout;
  // The largest scale known to fit and the smallest known not to.
  double low = 0.0;
  double high = 2.0 * largest;
  double scale = demand.scale_for(kAim * kUsualFill * cells, largest);
  for (int attempt = 0; attempt < kMaxAttempts; ++attempt) {
    base::report_progress(execution.progress, static_cast<float>(attempt) / (attempt + 1.0f));
    scale = attempt + 1 == kMaxAttempts && !best ? tiny : std::max(scale, tiny);
    shaper.shape(scale, layout);
    std::optional<Packing> packing = pack_charts(layout.outlines, grid, columns);
    const int used = packing ? packing->used_columns : columns;
    if (packing && used <= grid) {
      layout.packing = std::move(*packing);
      std::swap(best ? *best : best.emplace(), layout);
      low = scale;
      if (scale >= largest || used >= kGoodUse * grid) {
        break;
      }
    } else if (scale <= tiny) {
      break;
    } else {
      high = scale;
    }
    if (high < kCloseScales * low) {
      break;
    }
    const double fill = demand.cells_at(scale) / (static_cast<double>(used) * grid);
    scale = demand.scale_for(kAim * fill * cells, largest);
    if (scale <= low || scale >= high) {
      scale = best ? 0.5 * (low + high) : kStepDown * high;
    }
  }
  return best;
}

}  // namespace snowbough::tree
