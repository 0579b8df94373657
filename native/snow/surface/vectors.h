#pragma once

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace snowbough::snow {

/// The vector scaled to length 1, or (0, 0, 0) for a vector of length 0.
inline glm::vec3 unit(const glm::vec3& v) {
  const float length = glm::length(v);
  return length > 1e-12f ? v / length : glm::vec3(0.0f);
}

}  // namespace snowbough::snow
