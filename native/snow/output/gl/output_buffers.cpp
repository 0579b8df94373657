#include "snow/output/gl/output_buffers.h"

#include <algorithm>

namespace snowbough::snow {
namespace {

/// `place_of` turns the rows' sources into places of the array that the sums are taken from.
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

int64_t largest_output_buffer(const TexelTable& table, const SeamTable& seams) {
  const int64_t texels = int64_t{table.resolution} * table.resolution;
  const auto terms = [](const WeightedRows& rows) {
    return static_cast<int64_t>(rows.source.size());
  };
  return std::max({4 * texels, 4 * int64_t{seams.u.length}, 4 * int64_t{seams.v.length},
                   16 * static_cast<int64_t>(table.texel.size()), 4 * terms(seams.u.ghosts),
                   4 * terms(seams.v.ghosts)});
}

OutputBuffers make_output_buffers(const TexelTable& table, const SeamTable& seams,
                                  const SmoothingPlan& plan) {
  OutputBuffers buffers;
  buffers.texel_count = static_cast<int32_t>(table.texel.size());
  buffers.resolution = table.resolution;
  buffers.passes = plan.passes;
  buffers.closing_passes = plan.closing_passes;
  buffers.texel = gpu::Buffer(table.texel);
  std::vector<uint32_t> level(table.texel.size(), 0);
  for (size_t i = 0; i < plan.level_u.size(); ++i) {
    level[i] = plan.level_u[i] | static_cast<uint32_t>(plan.level_v[i]) << 8;
  }
  buffers.level = gpu::Buffer(level);
  buffers.filter_levels =
      gpu::Buffer(static_cast<int64_t>(sizeof(filter_levels())), filter_levels().data());
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
