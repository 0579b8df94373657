#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "snow/seam_table.h"
#include "snow/texel_table.h"

namespace snowbough::snow {

/// The whole map, resolution^2 values, row 0 = v 0, from one an owned texel: continued beyond the
/// charts by kDilation texels with what lies there on the surface, so that interpolation at a seam
/// meets the same heights from both sides; 0 elsewhere.
std::vector<float> dilate_on_cpu(const TexelTable& table, const SeamTable& seams,
                                 const std::vector<float>& heights);

/// Makes both sides of every seam show the same height (see SeamLevelling), in place.
void level_seams_on_cpu(const SeamTable& seams, std::vector<float>& map);

/// The same as dilate_on_cpu for normals: continued with the nearest texel's, since the surface
/// beyond a seam has another tangent space; (0, 0, 1) elsewhere.
std::vector<glm::vec3> dilate_normals(const TexelTable& table, const SeamTable& seams,
                                      const std::vector<glm::vec3>& normals);

}  // namespace snowbough::snow
