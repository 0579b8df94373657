#include "tree/collars/cones.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

namespace snowbough::tree {
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
  // Most cones are farther than the nearest so far.
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

FieldValue ConeChain::distance_from(const glm::dvec3& p, size_t begin, size_t at, size_t end,
                                    double limit) const {
  FieldValue nearest{limit, glm::dvec3(0.0)};
  for (size_t i = at; i < end; ++i) cones_[i].take_nearer(p, nearest);
  for (size_t i = at; i > begin; --i) cones_[i - 1].take_nearer(p, nearest);
  return nearest;
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

}  // namespace snowbough::tree
