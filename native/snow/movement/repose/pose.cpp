#include "snow/movement/repose/pose.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <optional>

#include "snow/movement/repose/rigid_turn.h"

namespace snowbough::snow {
namespace {

/// Tolerances of a rigid motion: fractions of the object's size, and of its coordinates, which are
/// rounded.
constexpr double kOfSize = 1e-5;
constexpr double kOfCoordinates = 4e-7;
/// Quantisation of the up direction: a hundredth of a millimetre per metre.
constexpr double kUpSteps = 65536.0;

/// The shortest rotation that turns a direction upwards.
glm::dmat3 turning_up(const glm::dvec3& direction) {
  if (direction.z < -0.999) {
    // Half a turn about the x axis first.
    const glm::dmat3 over(1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, -1.0);
    return turning_up(over * direction) * over;
  }
  const double x = direction.x;
  const double y = direction.y;
  const double k = 1.0 / (1.0 + direction.z);
  return glm::dmat3(1.0 - x * x * k, -x * y * k, x, -x * y * k, 1.0 - y * y * k, y, -x, -y,
                    direction.z);
}

}  // namespace

/// Whether the object has only moved and rotated since the rest pose; if so, sets the up direction.
bool ReposePose::find_up(const std::vector<glm::vec3>& rest,
                         const std::vector<glm::vec3>& positions, size_t count, glm::dvec3& up) {
  if (count < 3 || rest.size() < count || positions.size() < count) return false;
  if (!has_corners_) corners_ = far_apart(rest, count);
  has_corners_ = true;
  const std::optional<glm::dmat3> turn = turn_between(rest, positions, corners_);
  if (!turn) return false;
  const double off = largest_error(rest, positions, count, *turn, corners_[0]);
  glm::vec3 largest(0.0f);
  for (size_t i = 0; i < count; ++i) {
    largest = glm::max(largest, glm::max(glm::abs(positions[i]), glm::abs(rest[i])));
  }
  const double size = glm::length(glm::dvec3(rest[corners_[1]]) - glm::dvec3(rest[corners_[0]]));
  const double coordinates = std::max(largest.x, std::max(largest.y, largest.z));
  if (!(off <= kOfSize * size + kOfCoordinates * coordinates)) return false;
  const glm::dvec3 row((*turn)[0].z, (*turn)[1].z, (*turn)[2].z);
  up = glm::normalize(glm::round(row * kUpSteps));
  return true;
}

bool ReposePose::set(const std::vector<glm::vec3>& rest, const std::vector<glm::vec3>& positions,
                     int32_t count) {
  positions_ = &positions;
  glm::dvec3 up(0.0);
  const bool was_rigid = is_rigid_;
  is_rigid_ = find_up(rest, positions, static_cast<size_t>(count), up);
  if (!is_rigid_) return true;
  if (was_rigid && up == up_) return false;
  up_ = up;
  const glm::dmat3 turn = turning_up(up);
  turned_.resize(static_cast<size_t>(count));
  for (size_t i = 0; i < turned_.size(); ++i) turned_[i] = glm::vec3(turn * glm::dvec3(rest[i]));
  return true;
}

}  // namespace snowbough::snow
