#include "snow/map_output.h"

#include <algorithm>

namespace snowbough::snow {
namespace {

constexpr int32_t kGroupSize = 64;
/// What smoothing.comp.glsl filters along.
constexpr int32_t kAlongU = 1;
constexpr int32_t kAlongV = 2;

void wait_for_writes() {
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

/// `place_of` turns the rows' sources into places of the array that the sums are taken from.
RowBuffers upload_rows(const WeightedRows& rows, const std::vector<int32_t>& target,
                       const std::vector<int32_t>* place_of) {
  RowBuffers buffers;
  buffers.count = static_cast<int32_t>(rows.size());
  std::vector<int32_t> source = rows.source;
  if (place_of != nullptr) {
    for (int32_t& s : source) s = (*place_of)[s];
  }
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
  buffers.ghosts = upload_rows(lines.ghosts, lines.ghost_place, &lines.place);
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
  buffers.dilation = upload_rows(seams.dilated_rows, seams.dilated, &table.texel);
  buffers.map = gpu::Buffer(int64_t{4} * table.resolution * table.resolution);
  return buffers;
}

void MapOutputPass::add_rows(const RowBuffers& rows, const gpu::Buffer& source,
                             const gpu::Buffer& target, bool nothing_without_terms) {
  if (rows.count == 0) return;
  rows_.use();
  rows_.bind("RowBegin", rows.begin);
  rows_.bind("RowSource", rows.source);
  rows_.bind("RowWeight", rows.weight);
  rows_.bind("RowTarget", rows.target);
  rows_.bind("SourceValues", source);
  rows_.bind("TargetValues", target);
  rows_.set("count", rows.count);
  rows_.set("nothing_without_terms", nothing_without_terms ? 1 : 0);
  rows_.dispatch_items(rows.count, kGroupSize);
  wait_for_writes();
}

void MapOutputPass::fill_ghosts(OutputBuffers::Lines& lines) {
  const gpu::Buffer& line = lines.line[lines.current];
  // Ghosts read texels and write ghosts: no row touches what another one reads.
  add_rows(lines.ghosts, line, line, true);
}

void MapOutputPass::filter(OutputBuffers& buffers, int32_t axes, bool last) {
  OutputBuffers::Lines& u = buffers.u;
  OutputBuffers::Lines& v = buffers.v;
  if ((axes & kAlongU) != 0) fill_ghosts(u);
  if ((axes & kAlongV) != 0) fill_ghosts(v);
  smoothing_.use();
  smoothing_.bind("LevelWeights", buffers.filter_levels);
  smoothing_.bind("Levels", buffers.level);
  smoothing_.bind("Texels", buffers.texel);
  smoothing_.bind("PlaceU", u.place);
  smoothing_.bind("PlaceV", v.place);
  smoothing_.bind("LineU", u.line[u.current]);
  smoothing_.bind("LineV", v.line[v.current]);
  smoothing_.bind("NextU", u.line[1 - u.current]);
  smoothing_.bind("NextV", v.line[1 - v.current]);
  smoothing_.bind("Map", buffers.map);
  smoothing_.set("count", buffers.texel_count);
  smoothing_.set("axes", axes);
  smoothing_.set("last", last ? 1 : 0);
  smoothing_.dispatch_items(buffers.texel_count, kGroupSize);
  wait_for_writes();
  u.current = 1 - u.current;
  v.current = 1 - v.current;
}

void MapOutputPass::run(const gpu::Texture& height_maps, int32_t layer, OutputBuffers& buffers) {
  gather_.use();
  gather_.bind_texture("height_maps", height_maps);
  gather_.bind("Texels", buffers.texel);
  gather_.bind("PlaceU", buffers.u.place);
  gather_.bind("PlaceV", buffers.v.place);
  gather_.bind("LineU", buffers.u.line[buffers.u.current]);
  gather_.bind("LineV", buffers.v.line[buffers.v.current]);
  gather_.bind("Map", buffers.map);
  gather_.set("layer", layer);
  gather_.set("count", buffers.texel_count);
  gather_.dispatch_items(buffers.texel_count, kGroupSize);
  wait_for_writes();

  for (int32_t pass = 0; pass < buffers.passes; ++pass) {
    filter(buffers, kAlongU, false);
    filter(buffers, kAlongV, false);
  }
  for (int32_t pass = 0; pass < buffers.closing_passes; ++pass) {
    filter(buffers, kAlongU | kAlongV, pass + 1 == buffers.closing_passes);
  }
  add_rows(buffers.dilation, buffers.map, buffers.map, false);
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
}

void MapOutputPass::run_normals(OutputBuffers& buffers, const TexelTable& table,
                                const std::vector<SurfaceMetric>& metrics) {
  OutputBuffers::Lines& u = buffers.u;
  OutputBuffers::Lines& v = buffers.v;
  refill_.use();
  refill_.bind("Texels", buffers.texel);
  refill_.bind("PlaceU", u.place);
  refill_.bind("PlaceV", v.place);
  refill_.bind("LineU", u.line[u.current]);
  refill_.bind("LineV", v.line[v.current]);
  refill_.bind("Map", buffers.map);
  refill_.set("count", buffers.texel_count);
  refill_.dispatch_items(buffers.texel_count, kGroupSize);
  wait_for_writes();
  fill_ghosts(u);
  fill_ghosts(v);

  const gpu::Buffer triangles(table.triangle);
  const gpu::Buffer metric_buffer(metrics);
  if (buffers.normals.bytes() == 0) {
    buffers.normals = gpu::Buffer(int64_t{16} * buffers.texel_count);
  }
  normals_.use();
  normals_.bind("TexelTriangle", triangles);
  normals_.bind("Metrics", metric_buffer);
  normals_.bind("PlaceU", u.place);
  normals_.bind("PlaceV", v.place);
  normals_.bind("LineU", u.line[u.current]);
  normals_.bind("LineV", v.line[v.current]);
  normals_.bind("Normals", buffers.normals);
  normals_.set("count", buffers.texel_count);
  normals_.dispatch_items(buffers.texel_count, kGroupSize);
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
}

}  // namespace snowbough::snow
