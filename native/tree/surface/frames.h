#pragma once

#include <array>
#include <glm/vec3.hpp>

namespace snowbough::tree {

/// Right-handed: u x v = normal. The four corners of a ring lie at u, v, -u, -v.
struct Frame {
  glm::dvec3 u{1.0, 0.0, 0.0};
  glm::dvec3 v{0.0, 1.0, 0.0};
  glm::dvec3 normal{0.0, 0.0, 1.0};
};

/// A frame whose ring has one side facing +X as far as `normal` (unit) allows.
Frame first_frame(const glm::dvec3& normal);

/// The frame rotated to another normal by the smallest rotation (parallel transport): the discrete
/// rotation-minimising frame of a polyline. At an exact reversal it rotates about u.
///
/// Source: J. Bloomenthal, "Calculation of Reference Frames along a Space Curve", Graphics Gems,
/// 1990.
Frame transport(const Frame& frame, const glm::dvec3& normal);

/// The frame around `normal` whose corners match the given four (in order, anticlockwise around it)
/// with the smallest total rotation.
Frame fit_frame(const std::array<glm::dvec3, 4>& corners, const glm::dvec3& normal);

/// The four corners of a ring, anticlockwise seen against the normal.
std::array<glm::dvec3, 4> ring_corners(const Frame& frame, const glm::dvec3& centre,
                                       double corner_radius);

/// Outward direction of the side between corner `side` and the next one.
glm::dvec3 side_direction(const Frame& frame, int side);

}  // namespace snowbough::tree
