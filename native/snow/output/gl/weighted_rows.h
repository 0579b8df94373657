#pragma once

#include "gpu/program.h"
#include "snow/output/gl/output_buffers.h"

namespace snowbough::snow {

/// Weighted sums on the GPU: ghosts beyond a seam, a map's extension beyond its charts. GPU thread.
class WeightedRowsPass {
 public:
  /// Writes every row's sum over `source` to its target. Both may be the same buffer, since no row
  /// writes a value that another reads. A row without terms writes kNothing if
  /// `nothing_without_terms`, else 0.
  void run(const RowBuffers& rows, const gpu::Buffer& source, const gpu::Buffer& target,
           bool nothing_without_terms);
  /// Fills the ghosts of the current line array.
  void fill_ghosts(OutputBuffers::Lines& lines);

 private:
  gpu::Program program_{{"weighted_rows.comp.glsl"}};
};

}  // namespace snowbough::snow
