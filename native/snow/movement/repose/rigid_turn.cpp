#include "snow/movement/repose/rigid_turn.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace snowbough::snow {
namespace {

/// Squared sine of the angle below which three points lie on a line.
constexpr double kLine = 1e-8;

/// The point for which `measure` is largest.
template <typename Measure>
size_t farthest(const std::vector<glm::vec3>& points, size_t count, const Measure& measure) {
  size_t best = 0;
  double most = -1.0;
  for (size_t i = 0; i < count; ++i) {
    const double own = measure(glm::dvec3(points[i]));
    if (own > most) {
      most = own;
      best = i;
    }
  }
  return best;
}

/// An orthonormal frame from three points; false if they lie on a line.
bool frame_of(const std::vector<glm::vec3>& points, const std::array<size_t, 3>& corners,
              glm::dmat3& frame) {
  const glm::dvec3 origin(points[corners[0]]);
  const glm::dvec3 x = glm::dvec3(points[corners[1]]) - origin;
  const glm::dvec3 z = glm::cross(x, glm::dvec3(points[corners[2]]) - origin);
  const double square = glm::dot(x, x);
  if (!(square > 0.0) || !(glm::dot(z, z) > kLine * square * square)) return false;
  frame[0] = glm::normalize(x);
  frame[2] = glm::normalize(z);
  frame[1] = glm::cross(frame[2], frame[0]);
  return true;
}

}  // namespace

std::array<size_t, 3> far_apart(const std::vector<glm::vec3>& points, size_t count) {
  const glm::dvec3 first(points[0]);
  const size_t second =
      farthest(points, count, [&](const glm::dvec3& p) { return glm::dot(p - first, p - first); });
  const glm::dvec3 along = glm::dvec3(points[second]) - first;
  const size_t third = farthest(points, count, [&](const glm::dvec3& p) {
    const glm::dvec3 aside = glm::cross(along, p - first);
    return glm::dot(aside, aside);
  });
  return {0, second, third};
}

std::optional<glm::dmat3> turn_between(const std::vector<glm::vec3>& from,
                                       const std::vector<glm::vec3>& to,
                                       const std::array<size_t, 3>& corners) {
  glm::dmat3 before;
  glm::dmat3 after;
  if (!frame_of(from, corners, before) || !frame_of(to, corners, after)) return std::nullopt;
  return after * glm::transpose(before);
}

double largest_error(const std::vector<glm::vec3>& from, const std::vector<glm::vec3>& to,
                     size_t count, const glm::dmat3& turn, size_t corner) {
  const glm::dvec3 origin(from[corner]);
  const glm::dvec3 now(to[corner]);
  double most = 0.0;
  for (size_t i = 0; i < count; ++i) {
    const glm::dvec3 there = turn * (glm::dvec3(from[i]) - origin) + now;
    most = std::max(most, glm::length(glm::dvec3(to[i]) - there));
  }
  return most;
}

}  // namespace snowbough::snow
