#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "snow/seams/seam_table.h"
#include "snow/texels/texel_table.h"

namespace snowbough::snow {

/// Extends a map beyond its charts by kDilation texels with the heights of the adjacent surface, so
/// that interpolation at a seam reads the same heights from both sides. `map`: resolution^2
/// heights, row 0 = v 0, 0 beyond the charts; changed in place.
void dilate_heights(const TexelTable& table, const SeamTable& seams, std::vector<float>& map);

/// Expands normals per owned texel to the whole map, extended with the nearest texel's normal,
/// since the surface beyond a seam has another tangent space; (0, 0, 1) elsewhere.
std::vector<glm::vec3> dilate_normals(const TexelTable& table, const SeamTable& seams,
                                      const std::vector<glm::vec3>& normals);

}  // namespace snowbough::snow
