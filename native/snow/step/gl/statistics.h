#pragma once

#include "gpu/program.h"
#include "snow/step/gl/scene_buffers.h"
#include "snow/step/gl/work_group_size.h"

namespace snowbough::snow {

/// Keeps every receiver's balance on the GPU, so that no step has to wait for a read.
class StatisticsPass {
 public:
  /// `local_size`: the stability pass's. GPU thread.
  explicit StatisticsPass(int32_t local_size = snow::local_size())
      : sums_({"statistics.comp.glsl"}, {local_size_define(local_size)}) {}

  /// Sets the step's sums to zero; before the deposit. GPU thread.
  void open(SceneBuffers& scene);
  /// Adds up the stability pass's work groups and brings the totals up to date. `pixel_area` in m2.
  /// GPU thread.
  void close(SceneBuffers& scene, float pixel_area);

 private:
  gpu::Program sums_;
  gpu::Program open_{{"statistics_step.comp.glsl"}, {"OPENING"}};
  gpu::Program close_{{"statistics_step.comp.glsl"}};
};

}  // namespace snowbough::snow
