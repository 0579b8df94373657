#pragma once

#include <memory>

#include "gpu/program.h"
#include "gpu/resources.h"
#include "gpu/thread_texture.h"
#include "snow/output/gl/output_buffers.h"
#include "snow/output/gl/weighted_rows.h"
#include "snow/seams/seam_table.h"
#include "snow/texels/texel_table.h"

namespace snowbough::snow {

/// Makes a receiver's output on the GPU for the real-time renderer, without read-back. The map is
/// smoothed by the thesis's separable Gaussian across seams, repeated until its standard deviation
/// is the blur radius, and extended beyond the charts. Bakes use Smoother, which keeps the volume
/// and follows the depth; here heights differ by a few per cent where snow thins out. GPU thread.
///
/// Method: D. T. Reynolds, PhD thesis, University of East Anglia, 2014, section 4.2.1.
class LiveFilter {
 public:
  /// `blur_radius`: standard deviation in metres; 0: no smoothing.
  LiveFilter(std::shared_ptr<gpu::GpuThread> thread, const TexelTable& table,
             const SeamTable& seams, double blur_radius);

  /// Input of run(): the stored heights, resolution^2 floats, metres, row 0 = v 0.
  gpu::Buffer& map() { return buffers_.map; }
  /// The output of map(): R32F, resolution x resolution, linear filtering. Always the same texture,
  /// with new content.
  const gpu::ThreadTexture& run();

  /// Number of smoothing rounds over both axes.
  int32_t rounds() const { return rounds_; }

 private:
  void smooth(OutputBuffers::Lines& lines);

  OutputBuffers buffers_;
  int32_t rounds_ = 0;
  gpu::ThreadTexture output_;
  gpu::Program gather_{{"output_gather.comp.glsl"}};
  gpu::Program smooth_{{"smooth_lines.comp.glsl"}};
  gpu::Program texture_{{"map_texture.comp.glsl"}};
  WeightedRowsPass rows_;
};

}  // namespace snowbough::snow
