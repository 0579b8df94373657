#include "snow/normals_pass.h"

namespace snowbough::snow {

void NormalsPass::run(OutputBuffers& buffers, const TexelTable& table,
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
  refill_.dispatch_items(buffers.texel_count, kOutputGroup);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  rows_.fill_ghosts(u);
  rows_.fill_ghosts(v);

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
  normals_.dispatch_items(buffers.texel_count, kOutputGroup);
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
}

}  // namespace snowbough::snow
