#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <vector>

#include "tree/tubes/limb_tubes.h"

namespace snowbough::tree {

/// Distance from a surface, negative inside, and its gradient, a unit vector.
struct FieldValue {
  double distance = 0.0;
  glm::dvec3 gradient{0.0};
};

/// A limb between two of its sections.
struct Cone {
  glm::dvec3 begin{0.0}, along{0.0};
  double begin_radius = 0.0, widening = 0.0;
  /// 1 / squared length; 0 for zero length.
  double per_square = 0.0;

  static Cone between(const glm::dvec3& begin, double begin_radius, const glm::dvec3& end,
                      double end_radius);

  /// Sets `nearest` to the distance from this cone if it is smaller.
  void take_nearer(const glm::dvec3& p, FieldValue& nearest) const;
};

/// All cones of a chain of limbs, in order.
class ConeChain {
 public:
  /// The index of the next cone to be added.
  size_t size() const { return cones_.size(); }

  void add(std::span<const TubeSection> sections);

  const Cone& front() const { return cones_.front(); }

  /// Distance from the cones from `begin` to `end`, taken from `at` forwards, then backwards;
  /// `limit` without a gradient if they are not nearer than that.
  FieldValue distance_from(const glm::dvec3& p, size_t begin, size_t at, size_t end,
                           double limit = 1e300) const;

  /// From cone `from`: the end of the cones within `length` along the chain; the second, backwards:
  /// the first of these.
  size_t end_within(size_t from, double length) const;
  size_t begin_within(size_t from, double length) const;

 private:
  std::vector<Cone> cones_;
  /// Arc length at each cone and, last, at the end.
  std::vector<double> lengths_{0.0};
};

/// A chain's cones on both sides of a place. Limbs that leave the same parent share its cones.
struct ConeRun {
  std::shared_ptr<const ConeChain> chain;
  size_t begin = 0, at = 0, end = 0;

  /// The cones within `length` along the chain on both sides of cone `at`.
  static ConeRun around(std::shared_ptr<const ConeChain> chain, size_t at, double length);

  FieldValue distance_from(const glm::dvec3& p, double limit) const {
    return chain->distance_from(p, begin, at, end, limit);
  }
};

}  // namespace snowbough::tree
