#pragma once

#include <cstdint>
#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>
#include <vector>

namespace snowbough::snow {

/// How a deforming mesh has turned at each of its vertices between two poses: the turn that takes
/// the mean normal and the direction to a fixed neighbour from the one pose to the other. No turn
/// where faces have no area.
/// @param triangles three vertices each. @param now as many positions as `before`.
std::vector<glm::quat> vertex_turns(const std::vector<int32_t>& triangles,
                                    const std::vector<glm::vec3>& before, const glm::vec3* now);

}  // namespace snowbough::snow
