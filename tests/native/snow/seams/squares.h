#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "snow/seams/seam_walk.h"
#include "snow/texels/charts.h"

// Two squares that share an edge, for the tests of walks across seams.
namespace snowbough::snow {

inline constexpr int32_t kResolution = 100;
using Layout = std::function<glm::vec2(glm::vec2)>;

/// Two square metres that share the edge x = 1: one of x from 0 to 1, which lies on texels 10 to
/// 30, and one of x from 1 to 2, which `other` lays onto the map and `fold` puts elsewhere.
struct Squares {
  MapTopology topology;
  std::vector<glm::vec3> positions;

  explicit Squares(const Layout& other, glm::vec3 fold = {1, 0, 0}) {
    const std::vector<glm::vec2> flat{{0, 0}, {1, 0}, {1, 1}, {0, 1}, {2, 0}, {2, 1}};
    for (const glm::vec2 p : flat) {
      positions.push_back(p.x <= 1.0f ? glm::vec3(p, 0.0f) : glm::vec3(1, p.y, 0) + fold);
    }
    topology.resolution = kResolution;
    topology.vertex_count = 6;
    topology.triangles = {0, 1, 2, 0, 2, 3, 1, 4, 5, 1, 5, 2};
    for (size_t i = 0; i < topology.triangles.size(); ++i) {
      const glm::vec2 p = flat[topology.triangles[i]];
      topology.corner_uv.push_back(i < 6 ? 0.1f + 0.2f * p : other(p));
    }
  }

  SeamWalk walk() const { return {topology, find_charts(topology), positions}; }
};

/// Turned by a quarter and twice as fine.
inline glm::vec2 turned(glm::vec2 p) {
  return {0.9f - 0.4f * p.y, 0.1f + 0.4f * p.x};
}

/// Seen from behind, and four times as fine along x as along y.
inline glm::vec2 mirrored(glm::vec2 p) {
  return {0.5f + 0.1f * p.y, 0.1f + 0.4f * p.x};
}

}  // namespace snowbough::snow
