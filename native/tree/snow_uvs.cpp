#include "tree/snow_uvs.h"

#include <algorithm>
#include <cmath>
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

/// Shapes and outlines at `scale` texels a metre, longest first: what stands long sets the columns
/// that shorter charts fill.
Layout shape_layout(const std::vector<Strip>& strips, double scale, int resolution) {
  const int cell_size = cell_size_of(resolution);
  const double max_height = (grid_of(resolution) - 2.0) * cell_size;
  Layout layout;
  for (size_t i = 0; i < strips.size(); ++i) {
    const Strip& strip = strips[i];
    const std::vector<double> lengths = row_lengths(strip, scale);
    const double caps = 0.25 * scale *
                        ((strip.root_cap >= 0 ? strip.rings.front().perimeter() : 0.0) +
                         (strip.tip_cap >= 0 ? strip.rings.back().perimeter() : 0.0));
    const double max_length = std::max(max_height - caps - 1.0, 0.25 * max_height);
    for (const StripPiece& piece : cut_strip(strip, static_cast<int32_t>(i), lengths, max_length)) {
      layout.shapes.push_back(shape_chart(strip, piece, lengths, scale, max_height));
    }
  }
  std::stable_sort(layout.shapes.begin(), layout.shapes.end(),
                   [](const ChartShape& a, const ChartShape& b) { return a.height > b.height; });
  layout.outlines.reserve(layout.shapes.size());
  for (const ChartShape& shape : layout.shapes) {
    layout.outlines.push_back(footprint(shape, strips[shape.piece.strip], cell_size));
  }
  return layout;
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

/// The layout at the largest scale that fits; nothing if not even charts of minimum size fit.
std::optional<Layout> search_scale(const std::vector<Strip>& strips, int resolution) {
  const int grid = grid_of(resolution);
  const double cells = static_cast<double>(grid) * grid;
  std::optional<Layout> best;
  const auto attempt = [&](double scale) {
    Layout layout = shape_layout(strips, scale, resolution);
    if (!pack(layout, grid)) {
      return false;
    }
    best = std::move(layout);
    return true;
  };
  double high = largest_scale(strips, resolution);
  if (attempt(high)) {
    return best;
  }
  if (demand(shape_layout(strips, kTinyScale * high, resolution)) > cells) {
    return std::nullopt;
  }
  // The scale at which the charts and their gutters would fill the map without a gap.
  double bottom = 0.0;
  for (int step = 0; step < kDemandSteps; ++step) {
    const double middle = 0.5 * (bottom + high);
    (demand(shape_layout(strips, middle, resolution)) > cells ? high : bottom) = middle;
  }
  double low = kUsualShare * high;
  while (!attempt(low)) {
    high = low;
    low *= low > 0.5 * bottom ? 0.85 : 0.5;
    if (low < kTinyScale * bottom) {
      return std::nullopt;
    }
  }
  for (int step = 0; step < kSearchSteps; ++step) {
    const double middle = 0.5 * (low + high);
    (attempt(middle) ? low : high) = middle;
  }
  return best;
}

}  // namespace

void layout_snow_uvs(TreeMesh& mesh, const Skeleton& skeleton, int snow_resolution) {
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
  std::optional<Layout> layout = search_scale(strips, resolution);
  for (int larger = kMinResolution; !layout && larger <= kMaxResolution; larger *= 2) {
    if (larger > snow_resolution) {
      resolution = larger;
      layout = search_scale(strips, resolution);
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
  for (size_t i = 0; i < layout->shapes.size(); ++i) {
    const ChartShape& shape = layout->shapes[i];
    const Strip& strip = strips[shape.piece.strip];
    write_chart_uvs(mesh, strip, shape, choose_seam(strip, shape.piece), layout->outlines[i],
                    layout->placements[i], resolution, cell_size_of(resolution));
  }
}

}  // namespace snowbough::tree
