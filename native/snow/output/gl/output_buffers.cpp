#include "snow/output/gl/output_buffers.h"

namespace snowbough::snow {
namespace {

/// `place_of` maps the rows' sources to indices of the source array.
RowBuffers upload_rows(const WeightedRows& rows, const std::vector<int32_t>& target,
                       const std::vector<int32_t>& place_of) {
  RowBuffers buffers;
  buffers.count = static_cast<int32_t>(rows.size());
  std::vector<int32_t> source = rows.source;
  for (int32_t& s : source) s = place_of[s];
  buffers.begin = gpu::Buffer(rows.begin);
  buffers.source = gpu::Buffer(source);
  buffers.weight = gpu::Buffer(rows.weight);
  buffers.target = gpu::Buffer(target);
  return buffers;
}

OutputBuffers::Lines upload_lines(const TexelLines& lines) {
  OutputBuffers::Lines buffers;
  buffers.length = lines.length;
  buffers.place = gpu::Buffer(lines.place);
  for (gpu::Buffer& line : buffers.line) line = gpu::Buffer(int64_t{4} * lines.length);
  buffers.ghosts = upload_rows(lines.ghosts, lines.ghost_place, lines.place);
  return buffers;
}

}  // namespace

OutputBuffers make_output_buffers(const TexelTable& table, const SeamTable& seams) {
  OutputBuffers buffers;
  buffers.texel_count = static_cast<int32_t>(table.texel.size());
  buffers.resolution = table.resolution;
  buffers.texel = gpu::Buffer(table.texel);
  buffers.u = upload_lines(seams.u);
  buffers.v = upload_lines(seams.v);
  buffers.dilation = upload_rows(seams.dilated_rows, seams.dilated, table.texel);
  buffers.map = gpu::Buffer(int64_t{4} * table.resolution * table.resolution);
  return buffers;
}

void bind_lines(gpu::Program& program, const OutputBuffers& buffers) {
  program.bind("PlaceU", buffers.u.place);
  program.bind("PlaceV", buffers.v.place);
  program.bind("LineU", buffers.u.line[buffers.u.current]);
  program.bind("LineV", buffers.v.line[buffers.v.current]);
}

}  // namespace snowbough::snow
