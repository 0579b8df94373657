#include "map_topology.h"

#include <algorithm>
#include <limits>

namespace snowbough::python {

snow::MapTopology map_topology(const InputArray<int32_t>& triangles, const InputArray<float>& uv,
                               int32_t resolution, const std::string& who) {
  if (triangles.ndim() != 2 || triangles.shape(1) != 3) {
    throw std::invalid_argument(who + "triangles must have shape (T, 3)");
  }
  if (uv.ndim() != 3 || uv.shape(0) != triangles.shape(0) || uv.shape(1) != 3 || uv.shape(2) != 2) {
    throw std::invalid_argument(
        who + "uv must have shape (T, 3, 2), one coordinate per triangle corner, T = " +
        std::to_string(triangles.shape(0)));
  }
  snow::MapTopology topology;
  topology.resolution = resolution;
  topology.triangles.assign(triangles.data(), triangles.data() + triangles.size());
  const auto* corners = reinterpret_cast<const glm::vec2*>(uv.data());
  topology.corner_uv.assign(corners, corners + triangles.size());
  for (const int32_t index : topology.triangles) {
    if (index < 0 || index == std::numeric_limits<int32_t>::max()) {
      throw std::invalid_argument(who + "a triangle has the vertex index " + std::to_string(index));
    }
    topology.vertex_count = std::max(topology.vertex_count, index + 1);
  }
  return topology;
}

}  // namespace snowbough::python
