#include "snow/output/cpu_filter.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "base/parallel_for.h"
#include "snow/output/dilate.h"
#include "snow/output/normals.h"

namespace snowbough::snow {
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
  SmoothingGrid grid;
  base::parallel_for(2, [&](size_t part, size_t) {
    if (part == 0) {
      leveller.emplace(is_smoothed ? seams.levelling : SeamLevelling());
    } else if (is_smoothed) {
      grid = build_smoothing_grid(table, seams);
    }
  });
  return {std::move(*leveller), std::move(grid)};
}

MapOutput CpuFilter::run(std::vector<float> map, const OutputPose& pose) {
  if (is_smoothed_) {
    const std::scoped_lock lock(smoothing_);
    smoother_.run(map);
  }
  if (pose.layers != nullptr) show_layers(table_, *pose.layers, map, threads_);
  dilate_heights(table_, seams_, map);
  if (is_smoothed_) {
    const std::scoped_lock lock(levelling_);
    parts_.leveller.run(map);
  }
  MapOutput output;
  if (pose.maps.normal) output.normal = normal_map(table_, seams_, pose.metrics, map);
  if (pose.maps.wet && !pose.wet.empty()) {
    output.wet = pose.wet;
    dilate_heights(table_, seams_, output.wet);
  }
  output.height = std::move(map);
  return output;
}

}  // namespace snowbough::snow
