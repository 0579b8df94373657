#pragma once

#include <cstdint>

#include "gpu/program.h"
#include "gpu/resources.h"
#include "snow/output/gl/output_buffers.h"
#include "snow/output/gl/weighted_rows.h"

namespace snowbough::snow {

/// Smooths a receiver's map (see smoothing.h) and continues it beyond its charts, as CpuFilter does
/// on the processor. GPU thread.
class SmoothingPass {
 public:
  /// Leaves the heights of layer `layer` of `height_maps` (R32F array) in `buffers.map`.
  void run(const gpu::Texture& height_maps, int32_t layer, OutputBuffers& buffers);

 private:
  void filter(OutputBuffers& buffers, int32_t axes, bool last);

  gpu::Program gather_{{"output_gather.comp.glsl"}, {"FROM_TEXTURE"}};
  gpu::Program smoothing_{{"smoothing.comp.glsl"}};
  WeightedRowsPass rows_;
};

}  // namespace snowbough::snow
