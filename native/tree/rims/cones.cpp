#include "tree/rims/cones.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <utility>

namespace snowbough::tree {
namespace {

/// Cones per bounding sphere.
constexpr size_t kRun = 16;
/// Relative rounding error of a bounding sphere, with a large margin.
constexpr double kRounding = 1e-11;

}  // namespace

Cone Cone::between(const glm::dvec3& begin, double begin_radius, const glm::dvec3& end,
                   double end_radius) {
  const glm::dvec3 along = end - begin;
  const double square = glm::dot(along, along);
  return {begin, along, begin_radius, end_radius - begin_radius, square > 0.0 ? 1.0 / square : 0.0};
}

void Cone::take_nearer(const glm::dvec3& p, FieldValue& nearest) const {
  const glm::dvec3 to = p - begin;
  const double t = std::clamp(glm::dot(to, along) * per_square, 0.0, 1.0);
  const glm::dvec3 off = to - along * t;
  const double square = glm::dot(off, off);
  const double radius = begin_radius + widening * t;
  // Most cones are farther than the nearest so far: decided without a square root.
  const double least = nearest.distance + radius;
  if (least <= 0.0 || square >= least * least) return;
  const double length = std::sqrt(square);
  const double distance = length - radius;
  if (distance < nearest.distance) {
    nearest = {distance, length > 0.0 ? off / length : glm::dvec3(0.0, 0.0, 1.0)};
  }
}

void ConeChain::add(std::span<const TubeSection> sections) {
  for (size_t i = 0; i + 1 < sections.size(); ++i) {
    cones_.push_back(Cone::between(sections[i].centre, sections[i].radius, sections[i + 1].centre,
                                   sections[i + 1].radius));
    lengths_.push_back(lengths_.back() + glm::length(cones_.back().along));
  }
}

void ConeChain::finish() {
  for (size_t begin = 0; begin < cones_.size(); begin += kRun) {
    const size_t end = std::min(begin + kRun, cones_.size());
    glm::dvec3 low(1e300), high(-1e300);
    for (size_t i = begin; i < end; ++i) {
      const glm::dvec3 beyond = cones_[i].begin + cones_[i].along;
      low = glm::min(low, glm::min(cones_[i].begin, beyond));
      high = glm::max(high, glm::max(cones_[i].begin, beyond));
    }
    Ball& ball = balls_.emplace_back();
    ball.centre = 0.5 * (low + high);
    for (size_t i = begin; i < end; ++i) {
      const Cone& cone = cones_[i];
      // A cone is farthest out at one of its ends.
      const double one = glm::distance(cone.begin, ball.centre) + cone.begin_radius;
      const double other =
          glm::distance(cone.begin + cone.along, ball.centre) + cone.begin_radius + cone.widening;
      ball.radius = std::max({ball.radius, one, other});
    }
    const glm::dvec3 size = glm::abs(ball.centre);
    ball.radius += kRounding * (ball.radius + size.x + size.y + size.z);
  }
}

bool ConeChain::beyond(const Ball& ball, const glm::dvec3& p, const FieldValue& nearest) const {
  const double least = ball.radius + nearest.distance;
  const glm::dvec3 off = p - ball.centre;
  return least <= 0.0 || glm::dot(off, off) > least * least;
}

void ConeChain::take_nearer(const glm::dvec3& p, size_t begin, size_t end, bool back,
                            FieldValue& nearest) const {
  while (begin < end) {
    const size_t next = back ? (end - 1) / kRun * kRun : (begin / kRun + 1) * kRun;
    const size_t low = back ? std::max(begin, next) : begin;
    const size_t high = back ? end : std::min(end, next);
    if (!beyond(balls_[low / kRun], p, nearest)) {
      for (size_t i = low; i < high; ++i) {
        cones_[back ? low + high - 1 - i : i].take_nearer(p, nearest);
      }
    }
    (back ? end : begin) = back ? low : high;
  }
}

size_t ConeChain::end_within(size_t from, double length) const {
  const auto end = std::lower_bound(lengths_.begin() + static_cast<std::ptrdiff_t>(from),
                                    lengths_.end() - 1, lengths_[from] + length);
  return static_cast<size_t>(end - lengths_.begin());
}

size_t ConeChain::begin_within(size_t from, double length) const {
  // Backwards, the distance to a cone is that to its end.
  const auto first = std::upper_bound(lengths_.begin() + 1,
                                      lengths_.begin() + static_cast<std::ptrdiff_t>(from) + 1,
                                      lengths_[from] - length);
  return static_cast<size_t>(first - lengths_.begin()) - 1;
}

ConeRun ConeRun::around(std::shared_ptr<const ConeChain> chain, size_t at, double length) {
  const size_t begin = chain->begin_within(at, length), end = chain->end_within(at, length);
  return {std::move(chain), begin, at, end};
}

FieldValue ConeRun::distance_from(const glm::dvec3& p, double limit) const {
  FieldValue nearest{limit, glm::dvec3(0.0)};
  chain->take_nearer(p, at, end, false, nearest);
  chain->take_nearer(p, begin, at, true, nearest);
  return nearest;
}

}  // namespace snowbough::tree
