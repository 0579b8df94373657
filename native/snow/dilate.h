#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "snow/seam_table.h"
#include "snow/texel_table.h"

namespace snowbough::snow {

/// Continues a map (resolution^2 heights, row 0 = v 0) beyond its charts by kDilation texels with
/// what lies there on the surface, in place, so that interpolation at a seam meets the same heights
/// from both sides.
void continue_beyond_charts(const TexelTable& table, const SeamTable& seams,
                            std::vector<float>& map);

/// The whole map of normals from one an owned texel, continued with the nearest texel's, since the
/// surface beyond a seam has another tangent space; (0, 0, 1) elsewhere.
std::vector<glm::vec3> dilate_normals(const TexelTable& table, const SeamTable& seams,
                                      const std::vector<glm::vec3>& normals);

}  // namespace snowbough::snow
