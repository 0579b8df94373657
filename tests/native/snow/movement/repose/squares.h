#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "snow/scene/scene_object.h"

namespace snowbough::snow {

/// Squares of one metre that share an edge, each a quarter of a map of 64 texels: from the left and
/// from the middle of the map on. `ends`: of the second square's far edge; empty: no second square.
inline SceneObject squares(const std::vector<glm::vec3>& ends) {
  SceneObject object;
  MapTopology& topology = object.description.topology;
  topology.resolution = 64;
  object.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  object.positions.insert(object.positions.end(), ends.begin(), ends.end());
  topology.vertex_count = static_cast<int32_t>(object.positions.size());
  const auto add = [&](const std::vector<int32_t>& corners, float left) {
    const glm::vec2 uv[4] = {{left, 0}, {left + 0.5f, 0}, {left + 0.5f, 0.5f}, {left, 0.5f}};
    for (const size_t k : {0, 1, 2, 0, 2, 3}) {
      topology.triangles.push_back(corners[k]);
      topology.corner_uv.push_back(uv[k]);
    }
  };
  add({0, 1, 2, 3}, 0.0f);
  if (!ends.empty()) add({1, 4, 5, 2}, 0.5f);
  object.description.rest = object.positions;
  object.table = std::make_shared<const TexelTable>(build_texel_table(topology));
  return object;
}

/// The same with the second square in the upper half of the map, so that a seam is between them.
inline SceneObject squares_apart(const std::vector<glm::vec3>& ends) {
  SceneObject object = squares(ends);
  MapTopology& topology = object.description.topology;
  for (size_t c = 6; c < 12; ++c) topology.corner_uv[c].y += 0.5f;
  object.table = std::make_shared<const TexelTable>(build_texel_table(topology));
  return object;
}

}  // namespace snowbough::snow
