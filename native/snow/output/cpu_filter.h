#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "snow/output/dilate.h"
#include "snow/output/map_output.h"
#include "snow/output/smoothing.h"
#include "snow/output/smoothing_grid.h"
#include "snow/seams/curvature.h"
#include "snow/seams/seam_leveller.h"
#include "snow/seams/seam_table.h"
#include "snow/seams/surface_metric.h"
#include "snow/texels/texel_table.h"

namespace snowbough::snow {

/// A receiver's surface in the pose of a map.
struct OutputSurface {
  /// See layer_terms; null or empty: flat.
  std::shared_ptr<const std::vector<LayerTerms>> layers;
  /// See surface_metrics; empty where no normals are wanted.
  std::vector<SurfaceMetric> metrics;
};

/// Makes one receiver's output of its stored map: rounds it, turns what it holds into heights that
/// show as much on curved surfaces, continues and levels it, and takes its normals. Heights are
/// negative on the back of a surface.
///
/// Several threads may call run() at once: one smooths a map while another levels the one before.
class CpuFilter {
 public:
  /// `table` and `seams` must outlive it. `normals`: see build_smoothing_grid. The result does not
  /// depend on `threads`.
  CpuFilter(const TexelTable& table, const SeamTable& seams, const SmoothingSettings& settings,
            const std::vector<glm::vec3>& normals = {}, int32_t threads = 2);

  /// `map`: its resolution^2 heights as stored, in metres, row 0 = v 0, 0 where no chart owns the
  /// texel; handed back as the output's.
  MapOutput run(std::vector<float> map, const OutputSurface& surface = {});

 private:
  /// What the seams say, as each of the output's parts needs it.
  struct Parts {
    SeamLeveller leveller;
    MapContinuation continuation;
    SmoothingGrid grid;
  };
  static Parts build_parts(const TexelTable& table, const SeamTable& seams, bool is_smoothed,
                           const std::vector<glm::vec3>& normals);

  const TexelTable& table_;
  const SeamTable& seams_;
  int32_t threads_;
  bool is_smoothed_;
  Parts parts_;
  std::mutex levelling_;
  std::mutex smoothing_;
  Smoother smoother_;
};

}  // namespace snowbough::snow
