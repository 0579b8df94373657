#include "tree/surface/frames.h"

#include <cmath>
#include <glm/geometric.hpp>

namespace snowbough::tree {
namespace {

Frame from_u(const glm::dvec3& u, const glm::dvec3& normal) {
  Frame frame;
  frame.normal = normal;
  frame.u = glm::normalize(u - normal * glm::dot(u, normal));
  frame.v = glm::cross(normal, frame.u);
  return frame;
}

}  // namespace

Frame first_frame(const glm::dvec3& normal) {
  const glm::dvec3 x(1.0, 0.0, 0.0), y(0.0, 1.0, 0.0);
  const glm::dvec3 side = std::abs(glm::dot(x, normal)) < 0.9 ? x : y;
  const Frame facing = from_u(side, normal);
  return from_u(facing.u - facing.v, normal);
}

Frame transport(const Frame& frame, const glm::dvec3& normal) {
  const double cosine = glm::dot(frame.normal, normal);
  if (cosine < -0.999999) {
    return from_u(frame.u, normal);
  }
  // Rodrigues' rotation of one unit vector to another, without square roots.
  const glm::dvec3 axis = glm::cross(frame.normal, normal);
  const glm::dvec3 u = frame.u * cosine + glm::cross(axis, frame.u) +
                       axis * (glm::dot(axis, frame.u) / (1.0 + cosine));
  return from_u(u, normal);
}

Frame fit_frame(const std::array<glm::dvec3, 4>& corners, const glm::dvec3& normal) {
  const glm::dvec3 centre = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
  const Frame base = first_frame(normal);
  // Sum of the corners as complex numbers, each rotated back by its own quarter turns: its phase is
  // the rotation that maximises the correlation of the two rings.
  double x = 0.0, y = 0.0;
  for (int k = 0; k < 4; ++k) {
    double a = glm::dot(corners[k] - centre, base.u);
    double b = glm::dot(corners[k] - centre, base.v);
    for (int turn = 0; turn < k; ++turn) {
      const double old = a;
      a = b;
      b = -old;
    }
    x += a;
    y += b;
  }
  const double length = std::hypot(x, y);
  if (length < 1e-300) {
    return base;
  }
  return from_u(base.u * (x / length) + base.v * (y / length), normal);
}

std::array<glm::dvec3, 4> ring_corners(const Frame& frame, const glm::dvec3& centre,
                                       double corner_radius) {
  return {centre + frame.u * corner_radius, centre + frame.v * corner_radius,
          centre - frame.u * corner_radius, centre - frame.v * corner_radius};
}

glm::dvec3 side_direction(const Frame& frame, int side) {
  const std::array<glm::dvec3, 4> corners = {frame.u, frame.v, -frame.u, -frame.v};
  return (corners[side] + corners[(side + 1) % 4]) * std::sqrt(0.5);
}

}  // namespace snowbough::tree
