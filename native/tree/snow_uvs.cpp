#include "tree/snow_uvs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "tree/chart_shape.h"
#include "tree/pack_charts.h"
#include "tree/strip_rows.h"

namespace snowbough::tree {
namespace {

constexpr int kMinResolution = 16;
constexpr int kMaxResolution = 16384;
/// Finest packing grid: larger maps are packed in cells of several texels, to the same fill.
constexpr int kMaxGrid = 2048;
/// A row longer than the map may be squeezed to this share of its length; then the scale gives in.
constexpr double kMinSqueeze = 2.0 / 3.0;
/// At this share of the largest scale no chart is larger than it must be.
constexpr double kTinyScale = 1e-9;
/// Steps of the bisection for the scale at which the charts' areas alone would fill the map.
constexpr int kDemandSteps = 10;
/// Packing nearly always reaches this share of that scale and hardly ever the whole of it.
constexpr double kUsualShare = 0.9;
/// Steps of the bisection from there on.
constexpr int kSearchSteps = 5;
/// Strips or charts that a thread takes at a time.
constexpr size_t kStripBlock = 64;

/// All charts at one scale and where they lie.
struct Layout {
  std::vector<ChartShape> shapes;
  std::vector<PackShape> outlines;
  std::vector<Placement> placements;
};

int cell_size_of(int resolution) {
  return (resolution + kMaxGrid - 1) / kMaxGrid;
}

int grid_of(int resolution) {
  return resolution / cell_size_of(resolution);
}

/// Shapes and outlines of some strips at `scale` texels a metre.
Layout shape_strips(const std::vector<Strip>& strips, size_t begin, size_t end, double scale,
                    int resolution) {
  const int cell_size = cell_size_of(resolution);
  const double max_height = (grid_of(resolution) - 2.0) * cell_size;
  Layout layout;
  for (size_t i = begin; i < end; ++i) {
    const Strip& strip = strips[i];
    const std::vector<double> lengths = row_lengths(strip, scale);
    const double caps = 0.25 * scale *
                        ((strip.root_cap >= 0 ? strip.rings.front().perimeter() : 0.0) +
                         (strip.tip_cap >= 0 ? strip.rings.back().perimeter() : 0.0));
    const double max_length = std::max(max_height - caps - 1.0, 0.25 * max_height);
    for (const StripPiece& piece : cut_strip(strip, static_cast<int32_t>(i), lengths, max_length)) {
      const ChartShape& shape =
          layout.shapes.emplace_back(shape_chart(strip, piece, lengths, scale, max_height));
      layout.outlines.push_back(footprint(shape, strip, cell_size));
    }
  }
  return layout;
}

/// Shapes and outlines of all strips at `scale` texels a metre.
Layout shape_layout(const std::vector<Strip>& strips, double scale, int resolution,
                    const Execution& execution) {
  std::vector<Layout> parts((strips.size() + kStripBlock - 1) / kStripBlock);
  parallel_blocks(strips.size(), kStripBlock, execution, [&](size_t begin, size_t end) {
    parts[begin / kStripBlock] = shape_strips(strips, begin, end, scale, resolution);
  });
  Layout layout;
  for (Layout& part : parts) {
    std::move(part.shapes.begin(), part.shapes.end(), std::back_inserter(layout.shapes));
    std::move(part.outlines.begin(), part.outlines.end(), std::back_inserter(layout.outlines));
  }
  return layout;
}

/// Longest first: what stands long sets the columns that shorter charts fill.
void sort_layout(Layout& layout) {
  std::vector<size_t> order(layout.shapes.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    return layout.shapes[a].height > layout.shapes[b].height;
  });
  Layout sorted;
  for (const size_t i : order) {
    sorted.shapes.push_back(std::move(layout.shapes[i]));
    sorted.outlines.push_back(std::move(layout.outlines[i]));
  }
  layout = std::move(sorted);
}

/// Cells that the charts take with one side of their gutters: they cannot fit if it exceeds the
/// map.
double demand(const Layout& layout) {
  double cells = 0.0;
  for (const PackShape& outline : layout.outlines) {
    for (int column = 0; column < outline.width; ++column) {
      cells += outline.end[column] - outline.begin[column] + outline.gutter;
    }
    cells += static_cast<double>(outline.gutter) * (outline.height + outline.gutter);
  }
  return cells;
}

bool pack(Layout& layout, int grid) {
  if (demand(layout) > static_cast<double>(grid) * grid) {
    return false;
  }
  sort_layout(layout);
  auto placements = pack_charts(layout.outlines, grid);
  if (!placements) {
    return false;
  }
  layout.placements = std::move(*placements);
  return true;
}

/// Scale at which the longest single row still fits the map's height.
double largest_scale(const std::vector<Strip>& strips, int resolution) {
  double longest = 0.0;
  double widest = 0.0;
  for (const Strip& strip : strips) {
    for (size_t row = 0; row < strip.rows.size(); ++row) {
      const double width = 0.5 * (strip.rings[row].perimeter() + strip.rings[row + 1].perimeter());
      longest = std::max(longest, width > 0.0 ? strip.rows[row].area / width : 0.0);
      widest = std::max(widest, width);
    }
  }
  const double room = resolution - 4.0;
  return std::min(room / std::max(kMinSqueeze * longest, 1e-30),
                  0.9 * room / std::max(widest, 1e-30));
}

/// Tries to pack the strips at one scale after the other. While one scale is tried, the one that
/// will be asked for next if the answer is the same as the last time is tried beside it.
class ScaleSearch {
 public:
  ScaleSearch(const std::vector<Strip>& strips, int resolution, const Execution& execution)
      : strips_(strips), resolution_(resolution), execution_(execution) {}

  /// Whether the charts fit at `scale`; `best` becomes their layout if so.
  /// @param guess  the scale that may be asked for next.
  bool fits(double scale, double guess, std::optional<Layout>& best) {
    if (!guessed_ || guessed_scale_ != scale) {
      guessed_.reset();
      const bool alone = execution_.threads == 1;
      std::array<std::optional<Layout>, 2> layouts;
      // Each attempt by one thread: all of its steps but the first depend on one another.
      const Execution one{1, {}};
      parallel_blocks(alone ? 1 : 2, 1, {execution_.threads, {}}, [&](size_t begin, size_t) {
        Layout layout = shape_layout(strips_, begin == 0 ? scale : guess, resolution_, one);
        if (pack(layout, grid_of(resolution_))) {
          layouts[begin] = std::move(layout);
        }
      });
      if (!alone) {
        guessed_.emplace(std::move(layouts[1]));
        guessed_scale_ = guess;
      }
      return take(std::move(layouts[0]), best);
    }
    std::optional<Layout> layout = std::move(*guessed_);
    guessed_.reset();
    return take(std::move(layout), best);
  }

 private:
  static bool take(std::optional<Layout> layout, std::optional<Layout>& best) {
    if (!layout) {
      return false;
    }
    best = std::move(layout);
    return true;
  }

  const std::vector<Strip>& strips_;
  int resolution_;
  const Execution& execution_;
  /// What came of trying guessed_scale_.
  std::optional<std::optional<Layout>> guessed_;
  double guessed_scale_ = 0.0;
};

/// The layout at the largest scale that fits; nothing if not even charts of minimum size fit.
std::optional<Layout> search_scale(const std::vector<Strip>& strips, int resolution,
                                   const Execution& execution) {
  const int grid = grid_of(resolution);
  const double cells = static_cast<double>(grid) * grid;
  const Execution quiet{execution.threads, {}};
  const auto demand_at = [&](double scale) {
    return demand(shape_layout(strips, scale, resolution, quiet));
  };
  std::optional<Layout> best;
  double high = largest_scale(strips, resolution);
  {
    Layout layout = shape_layout(strips, high, resolution, quiet);
    if (pack(layout, grid)) {
      return layout;
    }
  }
  if (demand_at(kTinyScale * high) > cells) {
    return std::nullopt;
  }
  // The scale at which the charts and their gutters would fill the map without a gap.
  double bottom = 0.0;
  for (int step = 0; step < kDemandSteps; ++step) {
    report_progress(execution.progress, 0.3f * static_cast<float>(step) / kDemandSteps);
    const double middle = 0.5 * (bottom + high);
    (demand_at(middle) > cells ? high : bottom) = middle;
  }
  ScaleSearch search(strips, resolution, execution);
  double low = kUsualShare * high;
  const auto lower = [bottom](double scale) { return scale * (scale > 0.5 * bottom ? 0.85 : 0.5); };
  // The first attempt mostly succeeds.
  for (double next = 0.5 * (low + high); !search.fits(low, next, best); next = lower(low)) {
    report_progress(execution.progress, 0.4f);
    high = low;
    low = lower(low);
    if (low < kTinyScale * bottom) {
      return std::nullopt;
    }
  }
  bool rises = true;
  for (int step = 0; step < kSearchSteps; ++step) {
    report_progress(execution.progress, 0.5f + 0.5f * static_cast<float>(step) / kSearchSteps);
    const double middle = 0.5 * (low + high);
    const double next = 0.5 * (middle + (rises ? high : low));
    rises = search.fits(middle, next, best);
    (rises ? low : high) = middle;
  }
  return best;
}

}  // namespace

void layout_snow_uvs(TreeMesh& mesh, const Skeleton& skeleton, int snow_resolution,
                     const Execution& execution) {
  if (snow_resolution < kMinResolution || snow_resolution > kMaxResolution) {
    throw std::invalid_argument("snow_resolution must be " + std::to_string(kMinResolution) +
                                " to " + std::to_string(kMaxResolution) + ", not " +
                                std::to_string(snow_resolution));
  }
  mesh.uv_snow.assign(mesh.quads.size(), {});
  if (mesh.quads.empty()) {
    return;
  }
  const std::vector<Strip> strips = collect_strips(mesh, skeleton);
  int resolution = snow_resolution;
  std::optional<Layout> layout = search_scale(strips, resolution, execution);
  for (int larger = kMinResolution; !layout && larger <= kMaxResolution; larger *= 2) {
    if (larger > snow_resolution) {
      resolution = larger;
      layout = search_scale(strips, resolution, execution);
    }
  }
  if (!layout) {
    throw std::invalid_argument(
        "the tree's " + std::to_string(strips.size()) + " limbs fit on no snow map up to " +
        std::to_string(kMaxResolution) + ": simplify the tree or leave out its finest level");
  }
  if (resolution != snow_resolution) {
    mesh.warnings.push_back("A snow map of " + std::to_string(snow_resolution) +
                            " texels has no room for " + std::to_string(layout->shapes.size()) +
                            " charts two texels wide: UV map `snow` is laid out for " +
                            std::to_string(resolution) +
                            ", the smallest power of two that has; give the receiver at least "
                            "that resolution.");
  }
  // Every chart has quads of its own.
  parallel_blocks(
      layout->shapes.size(), kStripBlock, {execution.threads, {}}, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
          const ChartShape& shape = layout->shapes[i];
          const Strip& strip = strips[shape.piece.strip];
          write_chart_uvs(mesh, strip, shape, choose_seam(strip, shape.piece), layout->outlines[i],
                          layout->placements[i], resolution, cell_size_of(resolution));
        }
      });
}

}  // namespace snowbough::tree
