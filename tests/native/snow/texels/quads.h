#pragma once

#include <algorithm>
#include <cstdint>
#include <glm/vec2.hpp>
#include <utility>
#include <vector>

#include "snow/texels/texel_table.h"

// Layouts of a few triangles for the tests of charts and texels.
namespace snowbough::snow {

inline MapTopology topology_of(std::vector<int32_t> triangles, std::vector<glm::vec2> uv,
                               int32_t resolution) {
  MapTopology topology;
  topology.vertex_count = 0;
  for (const int32_t i : triangles) topology.vertex_count = std::max(topology.vertex_count, i + 1);
  topology.triangles = std::move(triangles);
  topology.corner_uv = std::move(uv);
  topology.resolution = resolution;
  return topology;
}

/// Two triangles over [left, right] x [bottom, top], with vertices of their own from `vertex` on.
inline void add_quad(MapTopology& topology, float left, float bottom, float right, float top) {
  const int32_t v = topology.vertex_count;
  topology.vertex_count += 4;
  for (const int32_t corner : {0, 1, 2, 0, 2, 3}) topology.triangles.push_back(v + corner);
  topology.corner_uv.insert(
      topology.corner_uv.end(),
      {{left, bottom}, {right, bottom}, {right, top}, {left, bottom}, {right, top}, {left, top}});
}

inline MapTopology quad_map(float left, float bottom, float right, float top, int32_t resolution) {
  MapTopology topology;
  topology.resolution = resolution;
  add_quad(topology, left, bottom, right, top);
  return topology;
}

}  // namespace snowbough::snow
