#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "snow/texels/texel_table.h"

namespace snowbough::snow {

/// The topology with coincident vertices merged, in the pose `positions` (vertex_count of them or
/// more): vertices closer along each axis than a millionth of the mesh's size. The first of them
/// represents all. O(vertices).
MapTopology merge_vertices(const MapTopology& topology, const std::vector<glm::vec3>& positions);

}  // namespace snowbough::snow
