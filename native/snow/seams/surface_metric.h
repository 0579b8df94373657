#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "snow/texels/texel_table.h"

namespace snowbough::snow {

/// First fundamental form of a triangle on its map: dot products, in m2, of the surface steps of
/// one texel along u and one along v. All 0 for a triangle without area on the map.
struct SurfaceMetric {
  float uu = 0.0f;
  float uv = 0.0f;
  float vv = 0.0f;
};

/// Per triangle, for the current `positions` (metres, vertex_count of them).
std::vector<SurfaceMetric> surface_metrics(const MapTopology& topology,
                                           const std::vector<glm::vec3>& positions);

/// The area of each owned texel at these positions, m2: the same sums as in a step.
std::vector<float> texel_areas(const MapTopology& topology, const TexelTable& table,
                               const std::vector<glm::vec3>& positions);

}  // namespace snowbough::snow
