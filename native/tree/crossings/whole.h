#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <utility>
#include <vector>

#include "tree/skeleton/tree_mesh.h"

namespace snowbough::tree {

/// All pairs of quads of a mesh that cross each other (faces_cross), the lower number first,
/// ascending.
std::vector<std::pair<int32_t, int32_t>> crossing_quads(const std::vector<glm::vec3>& vertices,
                                                        const std::vector<Quad>& quads);

}  // namespace snowbough::tree
