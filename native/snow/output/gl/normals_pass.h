#pragma once

#include <vector>

#include "gpu/program.h"
#include "snow/output/gl/output_buffers.h"
#include "snow/output/gl/weighted_rows.h"
#include "snow/seams/surface_metric.h"
#include "snow/texels/texel_table.h"

namespace snowbough::snow {

/// Takes a map's normals (see normals.h), as normals_on_cpu does on the processor. GPU thread.
class NormalsPass {
 public:
  /// Leaves the normals of `buffers.map` in `buffers.normals`, one an owned texel.
  void run(OutputBuffers& buffers, const TexelTable& table,
           const std::vector<SurfaceMetric>& metrics);

 private:
  gpu::Program refill_{{"output_gather.comp.glsl"}};
  gpu::Program normals_{{"normals.comp.glsl"}};
  WeightedRowsPass rows_;
};

}  // namespace snowbough::snow
