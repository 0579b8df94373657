#include "tree/collars/cones.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

namespace snowbough::tree {
namespace {

/// Excess of a block's sphere, relative to its coordinates: rounding must not skip the nearest
/// cone.
constexpr double kRounding = 1e-12;

/// Whether all within a radius around a point at this squared distance is at least as far as
/// `nearest`; decided without a square root.
bool is_beyond(double square, double radius, double nearest) {
  const double least = nearest + radius;
  return least <= 0.0 || square >= least * least;
}

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
  // Most cones are farther than the nearest so far.
  if (is_beyond(square, radius, nearest.distance)) return;
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
  // The last block so far may have been filled.
  if (!blocks_.empty()) blocks_.pop_back();
  while (blocks_.size() * kBlock < cones_.size()) blocks_.push_back(bound(blocks_.size()));
}

ConeChain::Block ConeChain::bound(size_t block) const {
  const size_t begin = block * kBlock, end = std::min(begin + kBlock, cones_.size());
  const Cone& middle = cones_[(begin + end) / 2];
  Block sphere{middle.begin, 0.0};
  double coordinates = 0.0;
  for (size_t i = begin; i < end; ++i) {
    const Cone& cone = cones_[i];
    const glm::dvec3 tip = cone.begin + cone.along;
    sphere.radius =
        std::max({sphere.radius, glm::distance(cone.begin, sphere.centre) + cone.begin_radius,
                  glm::distance(tip, sphere.centre) + cone.begin_radius + cone.widening});
    coordinates = std::max({coordinates, glm::length(cone.begin), glm::length(tip)});
  }
  sphere.radius += kRounding * (coordinates + sphere.radius);
  return sphere;
}

void ConeChain::take_nearer(const glm::dvec3& p, size_t begin, size_t end, bool back,
                            FieldValue& nearest) const {
  while (begin < end) {
    const size_t block = (back ? end - 1 : begin) / kBlock;
    const size_t from = std::max(begin, block * kBlock), to = std::min(end, (block + 1) * kBlock);
    const glm::dvec3 off = p - blocks_[block].centre;
    const bool is_far = is_beyond(glm::dot(off, off), blocks_[block].radius, nearest.distance);
    for (size_t i = from; i < to && !is_far; ++i) {
      cones_[back ? from + to - 1 - i : i].take_nearer(p, nearest);
    }
    (back ? end : begin) = back ? from : to;
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
