#include "snow/output/gl/gpu_filter.h"

#include <glm/vec4.hpp>

#include "snow/output/dilate.h"

namespace snowbough::snow {

MapOutput filter_on_gpu(OutputPasses& passes, OutputFilter& filter, const gpu::Texture& height_maps,
                        int32_t layer, const std::vector<SurfaceMetric>& metrics) {
  const TexelTable& table = filter.receiver().table;
  OutputBuffers buffers = make_output_buffers(table, filter.seams(), filter.plan());
  MapOutput output;
  passes.smoothing.run(height_maps, layer, buffers);
  output.height = buffers.map.read_all<float>();
  if (metrics.empty()) {
    return output;
  }
  filter.level(output.height);
  buffers.map.write(0, buffers.map.bytes(), output.height.data());
  passes.normals.run(buffers, table, metrics);
  const auto values = buffers.normals.read_all<glm::vec4>();
  output.normal = dilate_normals(table, filter.seams(), {values.begin(), values.end()});
  return output;
}

}  // namespace snowbough::snow
