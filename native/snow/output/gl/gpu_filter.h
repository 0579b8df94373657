#pragma once

#include <vector>

#include "gpu/resources.h"
#include "snow/output/gl/normals_pass.h"
#include "snow/output/gl/smoothing_pass.h"
#include "snow/output/map_output.h"
#include "snow/output/output_filter.h"

namespace snowbough::snow {

/// What makes output on the GPU. GPU thread.
struct OutputPasses {
  SmoothingPass smoothing;
  NormalsPass normals;
};

/// What OutputFilter::run makes, of layer `layer` of `height_maps` (R32F array). Where `metrics`
/// are empty, seams are not level yet: that is left to OutputFilter::level, so that the GPU need
/// not wait. GPU thread.
MapOutput filter_on_gpu(OutputPasses& passes, OutputFilter& filter, const gpu::Texture& height_maps,
                        int32_t layer, const std::vector<SurfaceMetric>& metrics);

}  // namespace snowbough::snow
