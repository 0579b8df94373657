#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <vector>

#include "snow/texels/texel_table.h"

namespace snowbough::snow {

/// How much of the snow a receiver takes, 0 (none) to 1 (all): weights of its vertices, or an
/// image.
struct SnowMask {
  /// Weights of the triangles' corners, T x 3; or, with an image, empty.
  std::vector<float> corner_weights;
  /// T x 3 texture coordinates in the image, which repeats beyond 0 to 1.
  std::vector<glm::vec2> corner_uv;
  /// width x height values, row 0 = v 0.
  int32_t width = 0;
  int32_t height = 0;
  std::vector<float> image;

  bool empty() const { return corner_weights.empty() && image.empty(); }
};

/// The mask at the sample point of each texel of the table; an image is sampled bilinearly.
/// @throws std::invalid_argument if the mask does not fit a mesh of `triangles` triangles, or has
/// values outside 0 to 1.
std::vector<float> texel_weights(const SnowMask& mask, const TexelTable& table, size_t triangles);

}  // namespace snowbough::snow
