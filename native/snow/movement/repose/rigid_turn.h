#pragma once

#include <array>
#include <cstddef>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

namespace snowbough::snow {

/// The first of the first `count` points, one far from it, and one far from the line through both.
std::array<size_t, 3> far_apart(const std::vector<glm::vec3>& points, size_t count);

/// The rotation that turns a triangle of `from`, given by three of its points, to the same of `to`;
/// none if either is nearly a line.
std::optional<glm::dmat3> turn_between(const std::vector<glm::vec3>& from,
                                       const std::vector<glm::vec3>& to,
                                       const std::array<size_t, 3>& corners);

/// The largest distance in metres between the first `count` points of `to` and those of `from`
/// after a turn and the motion of the first corner.
double largest_error(const std::vector<glm::vec3>& from, const std::vector<glm::vec3>& to,
                     size_t count, const glm::dmat3& turn, size_t corner);

}  // namespace snowbough::snow
