#include "snow/output/gl/weighted_rows.h"

namespace snowbough::snow {

void WeightedRowsPass::run(const RowBuffers& rows, const gpu::Buffer& source,
                           const gpu::Buffer& target, bool nothing_without_terms) {
  if (rows.count == 0) return;
  program_.use();
  program_.bind("RowBegin", rows.begin);
  program_.bind("RowSource", rows.source);
  program_.bind("RowWeight", rows.weight);
  program_.bind("RowTarget", rows.target);
  program_.bind("SourceValues", source);
  program_.bind("TargetValues", target);
  program_.set("count", rows.count);
  program_.set("nothing_without_terms", nothing_without_terms ? 1 : 0);
  program_.dispatch_items(rows.count, kOutputGroup);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

void WeightedRowsPass::fill_ghosts(OutputBuffers::Lines& lines) {
  const gpu::Buffer& line = lines.line[lines.current];
  // Ghosts read texels and write ghosts, so no row writes a value that another reads.
  run(lines.ghosts, line, line, true);
}

}  // namespace snowbough::snow
