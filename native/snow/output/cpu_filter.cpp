#include "snow/output/cpu_filter.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "base/parallel_for.h"
#include "snow/output/map_tiles.h"
#include "snow/output/normals.h"
#include "snow/output/smoothing_kernels.h"

namespace snowbough::snow {
namespace {

/// Per tile: whether it holds snow.
std::vector<uint8_t> filled_tiles(const std::vector<float>& map, int32_t resolution) {
  const MapTiles tiles(resolution);
  std::vector<uint8_t> filled(static_cast<size_t>(tiles.count()), 0);
  for (int32_t tile = 0; tile < tiles.count(); ++tile) {
    tiles.for_each_row(tile, [&](int32_t first, int32_t count) {
      if (holds_anything(map.data() + first, count)) filled[static_cast<size_t>(tile)] = 1;
    });
  }
  return filled;
}

}  // namespace

CpuFilter::CpuFilter(const TexelTable& table, const SeamTable& seams,
                     const SmoothingSettings& settings, int32_t threads)
    : table_(table),
      seams_(seams),
      threads_(std::max(1, threads)),
      is_smoothed_(settings.blur_radius > 0.0f),
      parts_(build_parts(table, seams, is_smoothed_)),
      smoother_(parts_.grid, settings, threads) {}

CpuFilter::Parts CpuFilter::build_parts(const TexelTable& table, const SeamTable& seams,
                                        bool is_smoothed) {
  std::optional<SeamLeveller> leveller;
  std::optional<MapContinuation> continuation;
  SmoothingGrid grid;
  base::parallel_for(2, [&](size_t part, size_t) {
    if (part == 0) {
      leveller.emplace(is_smoothed ? seams.levelling : SeamLevelling());
    } else {
      continuation.emplace(table, seams);
      if (is_smoothed) grid = build_smoothing_grid(table, seams);
    }
  });
  return {std::move(*leveller), std::move(*continuation), std::move(grid)};
}

MapOutput CpuFilter::run(std::vector<float> map, const OutputSurface& surface) {
  std::vector<uint8_t> filled;
  if (is_smoothed_) {
    const std::scoped_lock lock(smoothing_);
    filled = smoother_.run(map);
  } else {
    filled = filled_tiles(map, table_.resolution);
  }
  if (surface.layers != nullptr) show_layers(table_, *surface.layers, map, threads_);
  parts_.continuation.run(map, filled);
  if (is_smoothed_) {
    const std::scoped_lock lock(levelling_);
    parts_.leveller.run(map);
  }
  MapOutput output;
  if (surface.maps.normal) output.normal = normal_map(table_, seams_, surface.metrics, map);
  if (surface.maps.wet && !surface.wet.empty()) {
    output.wet = surface.wet;
    parts_.continuation.run(output.wet, filled_tiles(output.wet, table_.resolution));
  }
  output.height = std::move(map);
  return output;
}

}  // namespace snowbough::snow
