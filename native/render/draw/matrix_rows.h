#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <vector>

namespace snowbough::render {

/// Rows of matrices in the order in which shaders read them: three per matrix, as the fourth row is
/// (0, 0, 0, 1).
inline std::vector<glm::vec4> matrix_rows(std::span<const glm::mat4> matrices) {
  std::vector<glm::vec4> rows;
  rows.reserve(3 * matrices.size());
  for (const glm::mat4& m : matrices) {
    for (int row = 0; row < 3; ++row) {
      rows.emplace_back(m[0][row], m[1][row], m[2][row], m[3][row]);
    }
  }
  return rows;
}

}  // namespace snowbough::render
