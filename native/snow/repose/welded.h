#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "snow/texels/texel_table.h"

namespace snowbough::snow {

/// The topology with those vertices as one that lie in one place in the pose `positions`
/// (vertex_count of them or more): nearer to each other, along each axis, than a millionth of the
/// mesh's size. The first of them stands for all. O(vertices).
MapTopology welded(const MapTopology& topology, const std::vector<glm::vec3>& positions);

}  // namespace snowbough::snow
