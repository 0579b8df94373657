#pragma once

#include <cstdint>
#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>
#include <vector>

namespace snowbough::snow {

/// Rotation of a deforming mesh at each vertex between two poses. The rotation takes the mean
/// normal and the direction to a fixed neighbour from the first pose to the second. It is the
/// identity if the faces have no area.
/// @param triangles three vertex indices per triangle.
/// @param now as many positions as `before`.
std::vector<glm::quat> vertex_turns(const std::vector<int32_t>& triangles,
                                    const std::vector<glm::vec3>& before, const glm::vec3* now);

}  // namespace snowbough::snow
