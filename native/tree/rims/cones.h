#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <vector>

#include "tree/tubes/limb_tubes.h"

namespace snowbough::tree {

/// Distance from a surface, negative inside, and the unit direction in which it grows.
struct FieldValue {
  double distance = 0.0;
  glm::dvec3 gradient{0.0};
};

/// The stretch of a limb between two of its sections.
struct Cone {
  glm::dvec3 begin{0.0}, along{0.0};
  double begin_radius = 0.0, widening = 0.0;
  /// 1 over the square of its length; 0 of one without.
  double per_square = 0.0;

  static Cone between(const glm::dvec3& begin, double begin_radius, const glm::dvec3& end,
                      double end_radius);

  /// Takes the distance from it where that is less than what is nearest so far.
  void take_nearer(const glm::dvec3& p, FieldValue& nearest) const;
};

/// All cones of a chain of limbs, in order, with balls around runs of them.
class ConeChain {
 public:
  /// The number of the cone that is added next.
  size_t size() const { return cones_.size(); }

  void add(std::span<const TubeSection> sections);

  /// To be called once all are added, before anything else is asked.
  void finish();

  const Cone& front() const { return cones_.front(); }

  /// As Cone::take_nearer, of the cones from `begin` to `end`: forwards or, with `back`, backwards.
  void take_nearer(const glm::dvec3& p, size_t begin, size_t end, bool back,
                   FieldValue& nearest) const;

  /// From cone `from` on: the end of those to which the way along the chain is shorter than
  /// `length`; back from it: the first of those.
  size_t end_within(size_t from, double length) const;
  size_t begin_within(size_t from, double length) const;

 private:
  struct Ball {
    glm::dvec3 centre{0.0};
    double radius = 0.0;
  };

  /// Whether all cones of a ball are further away than `nearest`.
  bool beyond(const Ball& ball, const glm::dvec3& p, const FieldValue& nearest) const;

  std::vector<Cone> cones_;
  /// The way to each cone and, last, to the end.
  std::vector<double> ways_{0.0};
  /// Around every kRun cones, from the first on.
  std::vector<Ball> balls_;
};

/// A chain's cones on both sides of a place. Where many limbs leave one, each has much of it in
/// its surroundings: they have the cones in common.
struct ConeRun {
  std::shared_ptr<const ConeChain> chain;
  size_t begin = 0, at = 0, end = 0;

  /// Those to which the way from cone `at` on, or back from it, is shorter than `length`.
  static ConeRun around(std::shared_ptr<const ConeChain> chain, size_t at, double length);

  /// Distance from them.
  FieldValue distance_from(const glm::dvec3& p) const;
};

}  // namespace snowbough::tree
