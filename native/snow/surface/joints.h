#pragma once

#include <glm/vec3.hpp>
#include <vector>

namespace snowbough::snow {

/// How near the points of a drawn surface lie to where it goes on within the snow of another piece:
/// 1 there, 0 from `reach` metres along the surface on. Light that enters snow near such a joint
/// would come out within the other snow, in the dark.
/// @throws std::invalid_argument if a triangle has an index without a point.
std::vector<float> nearness_to_joints(const std::vector<glm::vec3>& points,
                                      const std::vector<glm::ivec3>& triangles, float reach);

}  // namespace snowbough::snow
