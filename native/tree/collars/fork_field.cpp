#include "tree/collars/fork_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

namespace snowbough::tree {
namespace {

/// Width of a fillet, in radii of the child's base: the smooth minimum begins where the distances
/// from both surfaces differ by this.
constexpr double kFillet = 1.0;
/// Fraction of a fork's reach at which its fillet begins to fade.
constexpr double kFullFillet = 0.45;
/// Reach of a fork in radii of the child's base, and its increase for a child that leaves
/// perpendicularly; more at flatter angles, up to the second angle's sine.
constexpr double kReach = 1.6;
constexpr double kReachAside = 1.6;
constexpr double kFlattest = 0.35;
/// The reach extends along a child that stays closer to its parent than this many of its own radii,
/// up to this many radii of the base.
constexpr double kClear = 1.7;
constexpr double kFarthest = 20.0;
/// Length of a child's tube inside its parent, straight inwards, and its thickness there, in corner
/// radii of the parent.
constexpr double kInside = 0.5;
constexpr double kInsideRadius = 0.4;
/// Length of both limbs' stretches, in reaches.
constexpr double kConeReach = 1.25;
/// Maximum number of limbs blended at one place.
constexpr size_t kMaxLimbs = 16;
/// Two surfaces whose normals differ by at least 60 degrees have their whole fillet, parallel ones
/// none: there the smooth minimum of tubes that hardly separate would be thicker than both.
constexpr double kAngleFillet = 2.0;

double smooth_step(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

FieldValue smooth_minimum(const FieldValue& a, const FieldValue& b, double width) {
  const double lengths = glm::length(a.gradient) * glm::length(b.gradient);
  const double cosine = lengths > 0.0 ? glm::dot(a.gradient, b.gradient) / lengths : 0.0;
  width *= std::min(1.0, kAngleFillet * (1.0 - cosine));
  if (width <= 0.0 || std::abs(a.distance - b.distance) >= width) {
    return a.distance <= b.distance ? a : b;
  }
  const double share = 0.5 + 0.5 * (b.distance - a.distance) / width;
  return {a.distance * share + b.distance * (1.0 - share) - width * share * (1.0 - share),
          a.gradient * share + b.gradient * (1.0 - share)};
}

/// Distance from the fork's centre at which its child, along `sections`, is clear of its parent; at
/// most kFarthest of its radii.
double clear_from(const Fork& fork, std::span<const TubeSection> sections) {
  const double farthest = kFarthest * fork.radius;
  double away = 0.0;
  for (const TubeSection& section : sections) {
    away = glm::distance(section.centre, fork.centre) + section.radius;
    if (away >= farthest || fork.from_parent(section.centre).distance > kClear * section.radius) {
      break;
    }
  }
  return std::min(away, farthest);
}

}  // namespace

double fillet_width(const Fork& fork, const glm::dvec3& p) {
  const double away = glm::distance(p, fork.centre) / fork.reach;
  return kFillet * fork.radius * (1.0 - smooth_step(kFullFillet, 1.0, away));
}

std::vector<Fork> collect_forks(const Surface& surface, const LimbTubes& tubes) {
  std::vector<std::shared_ptr<ConeChain>> all(surface.limbs.size());
  std::vector<size_t> first(surface.limbs.size());
  for (size_t b = 0; b < surface.limbs.size(); ++b) {
    std::shared_ptr<ConeChain>& chain = all[tubes.chain(static_cast<int32_t>(b))];
    if (!chain) chain = std::make_shared<ConeChain>();
    first[b] = chain->size();
    chain->add(tubes.sections(static_cast<int32_t>(b)));
  }
  std::vector<Fork> forks;
  forks.reserve(surface.junctions.size());
  for (const Junction& junction : surface.junctions) {
    Fork& fork = forks.emplace_back();
    fork.parent_chain = tubes.chain(junction.parent);
    fork.child_chain = tubes.chain(junction.child);
    const std::shared_ptr<ConeChain>& parent = all[fork.parent_chain];
    const std::shared_ptr<ConeChain>& child = all[fork.child_chain];
    const Ring& hole = surface.limbs[junction.child].rings.front();
    const Ring& low = surface.limbs[junction.parent].rings[junction.row];
    const TubeSection& base = tubes.sections(junction.child).front();
    fork.centre = base.centre;
    fork.radius = base.radius;
    fork.blends = tubes.first_sides(junction.child) > 4;
    const glm::dvec3 direction = glm::normalize(child->front().along);
    const double sine = std::max(glm::dot(direction, hole.normal), kFlattest);
    fork.reach = fork.radius * (kReach + kReachAside / sine);
    const size_t at = first[junction.parent] + tubes.first_section(junction.parent, junction.row);
    fork.parent = ConeRun::around(parent, at, kFarthest * fork.radius);
    fork.reach = std::max(fork.reach, clear_from(fork, tubes.sections(junction.child)));
    // The child's tube begins inside its parent, before its centreline, and so thin that it does
    // not show on the other side.
    const double inside = kInside * low.corner / sine;
    fork.inside = inside;
    const double tapered = std::min(base.radius, kInsideRadius * low.corner);
    fork.base = Cone::between(base.centre - direction * inside, tapered, base.centre, base.radius);
    const double length = kConeReach * fork.reach + 2.0 * low.corner;
    fork.child = ConeRun::around(child, 0, length);
    fork.parent = ConeRun::around(parent, at, length);
  }
  return forks;
}

FieldValue blended_distance(const glm::dvec3& p, std::span<const int32_t> at,
                            const std::vector<Fork>& forks) {
  struct Limb {
    int32_t chain;
    FieldValue value;
    double width;
  };
  std::array<Limb, kMaxLimbs> limbs;
  size_t count = 0;
  const auto add = [&](int32_t chain, const FieldValue& value, double width) {
    for (size_t i = 0; i < count; ++i) {
      if (limbs[i].chain == chain) {
        if (value.distance < limbs[i].value.distance) limbs[i].value = value;
        limbs[i].width = std::max(limbs[i].width, width);
        return;
      }
    }
    if (count < limbs.size()) limbs[count++] = {chain, value, width};
  };
  // Forks of one parent beside each other share most of its cones: all these once.
  for (size_t i = 0; i < at.size(); ++i) {
    const Fork& fork = forks[at[i]];
    size_t begin = fork.parent.begin, end = fork.parent.end;
    bool known = false;
    for (size_t k = 0; k < at.size(); ++k) {
      if (forks[at[k]].parent_chain != fork.parent_chain) continue;
      known |= k < i;
      begin = std::min(begin, forks[at[k]].parent.begin);
      end = std::max(end, forks[at[k]].parent.end);
    }
    if (known) continue;
    add(fork.parent_chain, fork.parent.chain->distance_from(p, begin, fork.parent.at, end), 0.0);
  }
  for (const int32_t f : at) {
    const Fork& fork = forks[f];
    double beyond = 1e300;
    const double width = fillet_width(fork, p);
    for (size_t i = 0; i < count; ++i) {
      if (limbs[i].chain == fork.parent_chain) beyond = limbs[i].value.distance + width;
    }
    // A child farther than that is not in the sum.
    FieldValue value = fork.child.distance_from(p, beyond);
    fork.base.take_nearer(p, value);
    if (value.distance < beyond) add(fork.child_chain, value, width);
  }
  // Parents have lower numbers than their children.
  std::sort(limbs.begin(), limbs.begin() + static_cast<std::ptrdiff_t>(count),
            [](const Limb& a, const Limb& b) { return a.chain < b.chain; });
  FieldValue sum = limbs[0].value;
  for (size_t i = 1; i < count; ++i) {
    sum = smooth_minimum(sum, limbs[i].value, limbs[i].width);
  }
  const double length = glm::length(sum.gradient);
  if (length > 1e-3) sum.gradient /= length;
  return sum;
}

}  // namespace snowbough::tree
