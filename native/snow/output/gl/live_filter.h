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

/// Makes a receiver's output on the GPU, for the real-time renderer: nothing is read back. It is
/// rounded by the thesis's separable Gaussian across seams, repeated until its sigma is the blur
/// radius, and continued beyond the charts. Bakes are rounded by Smoother, which keeps the volume
/// and follows the depth; here a height changes by a few per cent where snow thins out. GPU thread.
///
/// Method: D. T. Reynolds, PhD thesis, University of East Anglia, 2014, section 4.2.1.
class LiveFilter {
 public:
  /// `blur_radius`: sigma in metres; 0: the map is only continued.
  LiveFilter(std::shared_ptr<gpu::GpuThread> thread, const TexelTable& table,
             const SeamTable& seams, double blur_radius);

  /// Where the heights as stored go before run(): resolution^2 floats, metres, row 0 = v 0.
  gpu::Buffer& map() { return buffers_.map; }
  /// The output of what lies in map(): R32F, resolution x resolution, linear filtering. It is the
  /// same texture each time, with new content.
  const gpu::ThreadTexture& run();

  /// Times that both axes are rounded.
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
