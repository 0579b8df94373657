#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "tree/rings/squares.h"

namespace snowbough::tree {

/// A cross-section of a limb as a plane.
struct Plane {
  glm::dvec3 centre{0.0};
  /// Unit; zero for a plane without area, which ends a limb and counts as perpendicular to every
  /// direction.
  glm::dvec3 normal{0.0};
  double radius = 0.0;

  bool has_normal() const { return normal != glm::dvec3(0.0); }
  double across(const glm::dvec3& unit) const {
    return has_normal() ? std::abs(glm::dot(normal, unit)) : 1.0;
  }
  /// The side of the plane that faces a direction; a plane without area has only one side.
  int side(const glm::dvec3& towards) const { return glm::dot(normal, towards) < 0.0 ? 1 : 0; }
};

std::vector<Plane> planes_of(std::span<const CrossSection> sections);

/// Two planes that may be consecutive on a limb.
struct Link {
  double cost = 0.0;
  uint32_t from = 0, to = 0;
  uint8_t from_side = 0, to_side = 0;
  double length = 0.0;
};

/// The best links of every plane, per side. The planes must outlive it.
class Links {
 public:
  explicit Links(const std::vector<Plane>& planes);

  /// All links, cheapest first.
  std::vector<Link> sorted() const;

  /// The links of a plane's side, cheapest first.
  const std::vector<Link>& of(size_t plane, int side) const { return best_[plane][side]; }

  /// Whether another plane in between blocks the link.
  bool passes_through_another(const Link& link) const;

 private:
  double limit(uint32_t i) const;
  void consider(uint32_t i, uint32_t j);

  const std::vector<Plane>& planes_;
  std::vector<std::array<std::vector<Link>, 2>> best_;
};

}  // namespace snowbough::tree
