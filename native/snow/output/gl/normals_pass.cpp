#include "snow/output/gl/normals_pass.h"

namespace snowbough::snow {

void NormalsPass::run(OutputBuffers& buffers, const TexelTable& table,
                      const std::vector<SurfaceMetric>& metrics) {
  refill_.use();
  refill_.bind("Texels", buffers.texel);
  bind_lines(refill_, buffers);
  refill_.bind("Map", buffers.map);
  refill_.set("count", buffers.texel_count);
  refill_.dispatch_items(buffers.texel_count, kOutputGroup);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  rows_.fill_ghosts(buffers.u);
  rows_.fill_ghosts(buffers.v);

  const gpu::Buffer triangles(table.triangle);
  const gpu::Buffer metric_buffer(metrics);
  if (buffers.normals.bytes() == 0) {
    buffers.normals = gpu::Buffer(int64_t{16} * buffers.texel_count);
  }
  normals_.use();
  normals_.bind("TexelTriangle", triangles);
  normals_.bind("Metrics", metric_buffer);
  bind_lines(normals_, buffers);
  normals_.bind("Normals", buffers.normals);
  normals_.set("count", buffers.texel_count);
  normals_.dispatch_items(buffers.texel_count, kOutputGroup);
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
}

}  // namespace snowbough::snow
