#include "snow/movement/press/motion.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

namespace snowbough::snow {
namespace {

/// Largest error of a motion that counts as rigid, as a fraction of the object's size.
constexpr double kRigid = 1e-4;

/// An orthonormal frame from three points; false if they lie on a line.
bool frame_of(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, glm::dmat3& frame) {
  const glm::dvec3 x = b - a;
  const glm::dvec3 z = glm::cross(x, c - a);
  if (!(glm::dot(x, x) > 0.0) || !(glm::dot(z, z) > 1e-8 * glm::dot(x, x) * glm::dot(x, x))) {
    return false;
  }
  frame[0] = glm::normalize(x);
  frame[2] = glm::normalize(z);
  frame[1] = glm::cross(frame[2], frame[0]);
  return true;
}

/// The vertex for which `measure` is largest.
template <typename Measure>
size_t farthest(const std::vector<glm::vec3>& points, const Measure& measure) {
  size_t best = 0;
  double most = -1.0;
  for (size_t i = 0; i < points.size(); ++i) {
    const double own = measure(glm::dvec3(points[i]));
    if (own > most) {
      most = own;
      best = i;
    }
  }
  return best;
}

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
  const glm::dvec3 first(from.front());
  const size_t second =
      farthest(from, [&](const glm::dvec3& p) { return glm::dot(p - first, p - first); });
  const glm::dvec3 along = glm::dvec3(from[second]) - first;
  const size_t third = farthest(from, [&](const glm::dvec3& p) {
    const glm::dvec3 aside = glm::cross(along, p - first);
    return glm::dot(aside, aside);
  });
  glm::dmat3 before;
  glm::dmat3 after;
  const glm::dvec3 first_after(to.front());
  if (!frame_of(first, from[second], from[third], before) ||
      !frame_of(first_after, to[second], to[third], after)) {
    return false;
  }
  const glm::dmat3 turn = after * glm::transpose(before);
  const double most = kRigid * glm::length(along);
  for (size_t i = 0; i < from.size(); ++i) {
    const glm::dvec3 expected = first_after + turn * (glm::dvec3(from[i]) - first);
    if (glm::length(expected - glm::dvec3(to[i])) > most) return false;
    middle_ += glm::dvec3(from[i]) / static_cast<double>(from.size());
  }
  middle_after_ = first_after + turn * (middle_ - first);
  turn_ = glm::normalize(glm::quat_cast(turn));
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
