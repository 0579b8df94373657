#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

#include "base/simd.h"
#include "tree/surface/surface.h"

namespace snowbough::tree {

/// A face of a surface with all that the tests for crossings read of it.
struct CrossingFace {
  /// The four corners as floats, which is what the mesh has.
  base::Float4 x, y, z;
  /// Their vertices.
  base::Int4 corners;
  /// Sum of the corners.
  glm::vec3 sum;
  /// The box around them, and its three sides together.
  glm::vec3 low, high;
  float size;
  int32_t number;
};

CrossingFace make_crossing_face(std::span<const glm::dvec3> vertices, std::span<const Quad> quads,
                                int32_t number);

/// Whether two different faces have more in common than the corners they share: quads count as two
/// triangles, cut from corner 0 to 2. Exact; pairs that a plane parts with room to spare, nearly
/// all that are near each other, are told without the exact test.
/// @param f, g  faces whose boxes meet.
bool faces_cross(const CrossingFace& f, const CrossingFace& g);

}  // namespace snowbough::tree
