#pragma once

#include <array>
#include <glm/vec3.hpp>

namespace snowbough::tree {

using Triangle = std::array<glm::dvec3, 3>;

/// Sign of the volume of the tetrahedron a, b, c, d (positive when d sees a, b, c clockwise), exact
/// for coordinates that are floats.
///
/// Source: J. R. Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric
/// Predicates", Discrete & Computational Geometry 18, 1997.
int orientation(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d);

/// Whether two triangles intersect beyond the corners they share. `shared`: per corner of `a` the
/// corner of `b` that it coincides with, or -1. Triangles that share an edge intersect only if one
/// is folded flat onto the other.
bool triangles_cross(const Triangle& a, const Triangle& b, const std::array<int, 3>& shared);

}  // namespace snowbough::tree
