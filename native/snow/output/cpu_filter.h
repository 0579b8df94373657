#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

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
struct OutputPose {
  /// See layer_terms; null or empty: flat.
  std::shared_ptr<const std::vector<LayerTerms>> layers = {};
  /// See surface_metrics; empty if no maps are requested.
  std::vector<SurfaceMetric> metrics = {};
  MapRequest maps = {};
  /// Water by place, see MapOutput::wet; empty: none is followed.
  std::vector<float> wet = {};
};

/// Makes a receiver's output from its stored map: smooths it, converts the volume to heights on
/// curved surfaces, extends and levels it, and computes normals. Heights on the back of a surface
/// are negative.
///
/// Several threads may call run() at once: one smooths a map while another levels the previous one.
class CpuFilter {
 public:
  /// `table` and `seams` must outlive it. `threads` does not change the result.
  CpuFilter(const TexelTable& table, const SeamTable& seams, const SmoothingSettings& settings,
            int32_t threads = 2);

  /// `map`: resolution^2 stored heights in metres, row 0 = v 0, 0 for texels without owner; its
  /// memory is reused for the output.
  MapOutput run(std::vector<float> map, const OutputPose& pose = {});

 private:
  /// Tables from the seams.
  struct Parts {
    SeamLeveller leveller;
    SmoothingGrid grid;
  };
  static Parts build_parts(const TexelTable& table, const SeamTable& seams, bool is_smoothed);

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
