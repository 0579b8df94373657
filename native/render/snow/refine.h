#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "render/sources.h"

namespace snowbough::render {

/// A receiver's mesh cut into smaller triangles, told by its own: positions may change, the cuts
/// stay.
struct RefinedMesh {
  /// Per vertex: three vertices of the source and their weights.
  std::vector<std::array<int32_t, 3>> vertex_parents;
  std::vector<glm::vec3> vertex_weights;
  /// Per triangle: its vertices, the source's triangle that it is a part of, and where its corners
  /// lie in that (weights of its corners).
  std::vector<std::array<int32_t, 3>> triangles;
  std::vector<int32_t> source_triangle;
  std::vector<std::array<glm::vec3, 3>> corner_weights;
};

/// Cuts edges in half, each for both of its faces, until none covers more than `most_texels` texels
/// of a map of `resolution` x `resolution` on either side. O(triangles made).
RefinedMesh refine(const SnowSource& source, int32_t resolution, float most_texels);

}  // namespace snowbough::render
