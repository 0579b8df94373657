#include "tree/uv/snow_uvs.h"

#include <optional>
#include <stdexcept>
#include <string>

#include "tree/uv/chart_layout.h"
#include "tree/uv/chart_uvs.h"
#include "tree/uv/strip_pieces.h"
#include "tree/uv/strip_rows.h"

namespace snowbough::tree {
namespace {

constexpr int kMinResolution = 16;
constexpr int kMaxResolution = 16384;
/// Progress at which the charts are placed.
constexpr float kLayoutDone = 0.9f;
/// Charts per thread at a time.
constexpr size_t kChartBlock = 64;

}  // namespace

void layout_snow_uvs(TreeMesh& mesh, const Skeleton& skeleton, int snow_resolution,
                     const base::Execution& execution) {
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
  const base::Execution search = execution.part(0.0f, kLayoutDone);
  std::optional<ChartLayout> layout = lay_out_charts(strips, resolution, search);
  for (int larger = kMinResolution; !layout && larger <= kMaxResolution; larger *= 2) {
    if (larger > snow_resolution) {
      resolution = larger;
      layout = lay_out_charts(strips, resolution, search);
    }
  }
  if (!layout) {
    throw std::invalid_argument("the tree's " + std::to_string(strips.size()) +
                                " limbs do not fit a snow map of " +
                                std::to_string(kMaxResolution) +
                                " texels: simplify the tree or leave out its finest level");
  }
  if (resolution != snow_resolution) {
    mesh.warnings.push_back(
        "A snow map of " + std::to_string(snow_resolution) + " texels is too small for " +
        std::to_string(layout->shapes.charts.size()) +
        " charts two texels wide: UV map `snow` is laid out for " + std::to_string(resolution) +
        ", the smallest sufficient power of two; give the receiver at least "
        "that resolution.");
  }
  base::report_progress(execution.progress, kLayoutDone);
  // Charts have disjoint quads.
  base::parallel_for(layout->shapes.charts.size(), kChartBlock, {execution.threads, {}},
                     [&](size_t begin, size_t end) {
                       for (size_t i = begin; i < end; ++i) {
                         const ChartShape& chart = layout->shapes.charts[i];
                         const Strip& strip = strips[chart.piece.strip];
                         write_chart_uvs(strip, layout->shapes, chart,
                                         choose_seam(strip, chart.piece),
                                         layout->outlines.shapes[i], layout->packing.placements[i],
                                         layout->map, mesh);
                       }
                     });
}

}  // namespace snowbough::tree
