#pragma once

#include "gpu/program.h"
#include "snow/output/gl/output_buffers.h"

namespace snowbough::snow {

/// Weighted sums on the GPU: ghosts beyond a seam, a map's continuation beyond its charts. GPU
/// thread.
class WeightedRowsPass {
 public:
  /// Writes every row's sum over `source` to its target; both may be the same buffer, since rows
  /// never write what others read. A row without terms leaves kNothing where
  /// `nothing_without_terms`, else 0.
  void run(const RowBuffers& rows, const gpu::Buffer& source, const gpu::Buffer& target,
           bool nothing_without_terms);
  /// Fills the ghosts of the line array in use.
  void fill_ghosts(OutputBuffers::Lines& lines);

 private:
  gpu::Program program_{{"weighted_rows.comp.glsl"}};
};

}  // namespace snowbough::snow
