#pragma once

#include <memory>
#include <vector>

#include "snow/back_pixels.h"
#include "snow/deposit.h"
#include "snow/deposit_geometry.h"
#include "snow/fall_grid.h"
#include "snow/occlusion.h"
#include "snow/scene_buffers.h"
#include "snow/stability.h"
#include "snow/statistics.h"
#include "snow/texel_groups.h"
#include "snow/texel_surface.h"
#include "snow/triangle_fall.h"

namespace snowbough::snow {

/// How a deposit is computed.
enum class DepositMapping {
  /// Texels gather what they see of the sky (DepositPass): smooth, and bit-deterministic.
  kCompute,
  /// Pixels scatter their snow onto the texels under them (DepositGeometryPass): the thesis's
  /// Algorithm 1, for comparison.
  kGeometry,
};

/// One frame of snow, from vertices to heights.
class FrameStep {
 public:
  struct Input {
    FallSettings fall;
    StabilitySettings stability;
    /// Seconds.
    double dt = 0.0;
    DepositMapping mapping = DepositMapping::kCompute;
    int32_t tile_size = 2048;
  };

  /// Moved objects' positions are uploaded. GPU thread.
  void run(const std::vector<SceneObject*>& objects, SceneBuffers& scene, const Input& input);

 private:
  TriangleFallPass triangles_;
  TexelGroupsPass groups_;
  TexelSurfacePass surface_;
  OcclusionPass occlusion_;
  BackPixelsPass back_pixels_;
  DepositPass deposit_;
  /// Made when it is first asked for.
  std::unique_ptr<DepositGeometryPass> deposit_geometry_;
  StabilityPass stability_;
  StatisticsPass statistics_;
  OcclusionTarget target_;
  gpu::Buffer fall_{static_cast<int64_t>(sizeof(shared::FallFrame))};
};

}  // namespace snowbough::snow
