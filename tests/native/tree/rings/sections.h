#pragma once

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "tree/rings/squares.h"

// Squares across limbs for tests of their ordering.
namespace snowbough::tree {

/// A square of the given half diagonal across `along`.
inline CrossSection square_across(const glm::vec3& centre, const glm::vec3& along, float radius) {
  const glm::vec3 u = glm::normalize(glm::cross(along, glm::vec3(0.3f, 0.5f, 0.1f)));
  const glm::vec3 v = glm::normalize(glm::cross(along, u));
  return {{centre + radius * u, centre + radius * v, centre - radius * u, centre - radius * v}};
}

/// Squares every metre along z, tapering.
inline std::vector<CrossSection> pole(int count) {
  std::vector<CrossSection> sections;
  for (int i = 0; i < count; ++i) {
    sections.push_back(square_across({0, 0, i}, {0, 0, 1}, 0.5f - 0.05f * i));
  }
  return sections;
}

}  // namespace snowbough::tree
