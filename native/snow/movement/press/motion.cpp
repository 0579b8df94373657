#include "snow/movement/press/motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <optional>

#include "snow/movement/repose/rigid_turn.h"

namespace snowbough::snow {
namespace {

/// Largest error of a motion that counts as rigid, as a fraction of the object's size.
constexpr double kRigid = 1e-4;

}  // namespace

PresserMotion::PresserMotion(const std::vector<glm::vec3>& from, const std::vector<glm::vec3>& to)
    : from_(from.size() == to.size() ? &from : &to), to_(&to) {
  for (size_t i = 0; i < to.size(); ++i) {
    const glm::dvec3 way = glm::dvec3(to[i]) - glm::dvec3((*from_)[i]);
    travel_ = std::max(travel_, glm::length(way));
  }
  is_rigid_ = travel_ > 0.0 && find_turn();
}

bool PresserMotion::find_turn() {
  const std::vector<glm::vec3>& from = *from_;
  const std::vector<glm::vec3>& to = *to_;
  const std::array<size_t, 3> corners = far_apart(from, from.size());
  const std::optional<glm::dmat3> turn = turn_between(from, to, corners);
  if (!turn) return false;
  const glm::dvec3 first(from.front());
  const double size = glm::length(glm::dvec3(from[corners[1]]) - first);
  if (largest_error(from, to, from.size(), *turn, 0) > kRigid * size) return false;
  for (const glm::vec3& point : from) {
    middle_ += glm::dvec3(point) / static_cast<double>(from.size());
  }
  middle_after_ = glm::dvec3(to.front()) + *turn * (middle_ - first);
  turn_ = glm::normalize(glm::quat_cast(*turn));
  return true;
}

void PresserMotion::pose(double share, std::vector<glm::vec3>& points) const {
  // The poses themselves come back to the bit.
  if (share >= 1.0 || share <= 0.0 || travel_ == 0.0) {
    points = share <= 0.0 ? *from_ : *to_;
    return;
  }
  points.resize(to_->size());
  if (!is_rigid_) {
    for (size_t i = 0; i < points.size(); ++i) {
      points[i] = glm::vec3(glm::mix(glm::dvec3((*from_)[i]), glm::dvec3((*to_)[i]), share));
    }
    return;
  }
  const glm::dmat3 turn = glm::mat3_cast(glm::slerp(glm::dquat(1.0, 0.0, 0.0, 0.0), turn_, share));
  const glm::dvec3 middle = glm::mix(middle_, middle_after_, share);
  for (size_t i = 0; i < points.size(); ++i) {
    points[i] = glm::vec3(middle + turn * (glm::dvec3((*from_)[i]) - middle_));
  }
}

}  // namespace snowbough::snow
