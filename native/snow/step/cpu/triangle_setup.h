#pragma once

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>

#include "shaders/lib/snow_shared.h"

namespace snowbough::snow::cpu {

/// Evaluates every triangle on the current vertices as the fall of this step meets it: corners in
/// pixels of the grid and depth, slopes, area (shaders/lib/triangle_setup.h). First pass of a step;
/// all others build on it instead of on vertices. On all cores, any thread.
/// `positions` in metres; `corners` gets three elements a triangle and `surface` one.
/// @throws std::invalid_argument when these have not that many.
void set_up_triangles(std::span<const glm::vec3> positions,
                      std::span<const shared::SceneTriangle> triangles,
                      const shared::ProjectionFrame& frame, std::span<glm::vec4> corners,
                      std::span<glm::vec4> surface);

}  // namespace snowbough::snow::cpu
