#include "tree/surface/limb_base.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "tree/surface/frames.h"
#include "tree/surface/stations.h"

namespace snowbough::tree {
namespace {

/// Distance of the middle of a square ring's side from the centre, in corner radii.
const double kSideDistance = std::sqrt(0.5);
/// Maximum shift of a child's hole along the parent, in corner radii, for any angle.
constexpr double kLargestShift = 2.0;
/// A hole narrower than this fraction of the parent's side gets an inset.
constexpr double kInsetHoleBelow = 0.9;
/// Fraction of the knuckle's length for a hole with an inset. The faces before and behind it are
/// then long enough not to show as dark lines across the limb.
constexpr double kHoleLength = 0.55;
/// Fraction of the knuckle's length for a second stem's hole with an inset.
constexpr double kStemLength = 0.8;
/// Number of narrowing steps after which it becomes an ordinary child, and factor of its width per
/// step.
constexpr int kStemSteps = 3;
constexpr double kStemFactor = 0.95;
/// From the crotch on, a second stem's first ring is sought in steps of kStemStep, up to
/// kStemReach; joints closer to it than kStemGap are dropped. In the stem's corner radii.
constexpr double kStemStep = 0.1;
constexpr double kStemReach = 6.0;
constexpr double kStemGap = 0.5;
/// Maximum width of a child's base, relative to its parent's side: the parent's knuckle widens to
/// it as a branch collar.
constexpr double kWidest = 1.5;
/// Maximum widening of a child from its hole, per metre.
constexpr double kWidening = 1.2;
/// The points of a child's first ring rise from its hole at least at this fraction of its centre's
/// slope, otherwise it would hang over the parent's side with a gap under it.
constexpr double kMinRise = 0.5;
/// To rise enough, a child skips its own joints as long as it deviates from them by less than this
/// fraction of their corner radius.
constexpr double kLargestShortcut = 1.0;
/// Sample points of a ring.
constexpr int kRingSamples = 8;
/// Per narrowing step: factor of the base's width, and displacement of its first ring as a fraction
/// of the parent's corner radius.
constexpr double kNarrowingFactor = 0.7;
/// Limbs with over this fraction of their parent's width keep at least the same fraction of their
/// own: a wire at a fork shows more than faces that intersect.
constexpr double kThick = 0.5;
constexpr double kNarrowingMargin = 0.25;

/// Factor of the width of a base. @param child, parent  widths of both.
double narrowing_of(int steps, double child, double parent) {
  return std::max(std::pow(kNarrowingFactor, steps), child > kThick * parent ? kThick : 0.0);
}

glm::dvec3 across(const glm::dvec3& v, const glm::dvec3& axis) {
  return v - axis * glm::dot(v, axis);
}

/// First place on the child's path outside the parent's round hull, and the nearest arc length on
/// the parent.
struct Crossing {
  glm::dvec3 point;
  double parent_length;
  double child_length;
  bool starts_outside;
};

Crossing first_outside(const PathSearch& search, const LimbPath& child) {
  const LimbPath& parent = search.path();
  Crossing crossing{child.points[0], search.nearest_length(child.points[0]), 0.0, true};
  double before = 0.0;
  for (size_t i = 0; i < child.points.size(); ++i) {
    const double s = search.nearest_length(child.points[i]);
    const double outside =
        glm::distance(child.points[i], position_at(parent, s)) - corner_at(parent, s);
    if (outside >= 0.0 || i + 1 == child.points.size()) {
      if (i > 0) {
        const double t = outside > 0.0 ? -before / (outside - before) : 1.0;
        crossing.point = child.points[i - 1] + (child.points[i] - child.points[i - 1]) * t;
        crossing.child_length =
            child.lengths[i - 1] + (child.lengths[i] - child.lengths[i - 1]) * t;
        crossing.parent_length = search.nearest_length(crossing.point);
        crossing.starts_outside = false;
      }
      return crossing;
    }
    before = outside;
  }
  return crossing;
}

std::array<glm::dvec3, kRingSamples> ring_samples(const glm::dvec3& centre,
                                                  const glm::dvec3& normal, double corner) {
  const Frame frame = first_frame(normal);
  std::array<glm::dvec3, kRingSamples> samples;
  for (int k = 0; k < kRingSamples; ++k) {
    const double angle = 2.0 * M_PI / kRingSamples * k;
    samples[k] = centre + (frame.u * std::cos(angle) + frame.v * std::sin(angle)) * corner;
  }
  return samples;
}

/// Whether a ring is clear of the parent's round hull and in front of the whole hole.
bool ring_clears(const LimbHull& parent, const Hole& hole, const glm::dvec3& centre,
                 const glm::dvec3& normal, double corner, double margin) {
  if (glm::dot(centre - hole.centre, hole.normal) <= margin) {
    return false;
  }
  if (!parent.clears(centre, margin)) {
    return false;
  }
  for (const glm::dvec3& p : hole.corners) {
    if (glm::dot(centre - p, normal) <= margin) {
      return false;
    }
  }
  const auto samples = ring_samples(centre, normal, corner);
  return std::all_of(samples.begin(), samples.end(), [&](const glm::dvec3& p) {
    return glm::dot(p - hole.centre, hole.normal) > margin && parent.clears(p, margin);
  });
}

/// Whether a ring rises from the hole as steeply as its centre. Close to a hole that its limb
/// leaves obliquely, a ring extends beyond the hole's edge, hardly above the parent's side.
bool ring_rises(const Hole& hole, const glm::dvec3& centre, const glm::dvec3& normal,
                double corner) {
  const glm::dvec3 step = centre - hole.centre;
  const double height = glm::dot(step, hole.normal);
  const double aside = glm::length(across(step, hole.normal));
  const auto samples = ring_samples(centre, normal, corner);
  return std::all_of(samples.begin(), samples.end(), [&](const glm::dvec3& p) {
    double beyond = 0.0;
    for (int k = 0; k < 4; ++k) {
      const glm::dvec3& from = hole.corners[k];
      const glm::dvec3 outward = glm::cross(hole.corners[(k + 1) % 4] - from, hole.normal);
      beyond = std::max(beyond, glm::dot(p - from, outward) / glm::length(outward));
    }
    return glm::dot(p - hole.centre, hole.normal) * aside >= kMinRise * height * beyond;
  });
}

/// Whether the straight path from the hole to a joint passes close to the joints in between, from
/// `first` on, with about the same width.
bool is_shortcut(const LimbPath& child, const Hole& hole, size_t first, size_t joint) {
  const glm::dvec3 offset = child.points[joint] - hole.centre;
  for (size_t i = first; i < joint; ++i) {
    const glm::dvec3 to = child.points[i] - hole.centre;
    const double t = std::clamp(glm::dot(to, offset) / glm::dot(offset, offset), 0.0, 1.0);
    const double corner = hole.corner + (child.corners[joint] - hole.corner) * t;
    if (glm::distance(to, offset * t) + std::abs(corner - child.corners[i]) >
        kLargestShortcut * child.corners[i]) {
      return false;
    }
  }
  return true;
}

/// Gives a second stem the stretch of its parent along which both separate. False for others.
bool leave_as_stem(const PathSearch& search, double attach, const LimbPath& child,
                   const LengthLimits& scale, int narrowing_steps, Exit& exit) {
  const std::optional<Crotch> crotch = find_crotch(search, attach, child, scale);
  const double length = crotch ? crotch->parent_end - crotch->parent_heel : 0.0;
  if (!crotch) return false;
  const double middle = 0.5 * (crotch->parent_heel + crotch->parent_end);
  const double side = 2.0 * kSideDistance * corner_at(search.path(), middle);
  const double wanted = 2.0 * kSideDistance * corner_at(child, crotch->child_heel);
  exit.request.crotch = crotch;
  // Stems that lie side by side for long leave in the direction in which they separate.
  const glm::dvec3 apart =
      across(position_at(child, crotch->child_end) - position_at(search.path(), crotch->parent_end),
             direction_at(search.path(), crotch->parent_end));
  if (glm::length(apart) > scale.coincident) exit.request.direction = glm::normalize(apart);
  exit.request.position = middle;
  exit.request.heading = crotch->parent_end;
  exit.request.width = std::min(wanted, side) * std::pow(kStemFactor, narrowing_steps);
  if (length <= exit.request.width) return false;
  exit.request.hole_length = length;
  exit.request.length = exit.request.width < kInsetHoleBelow * side ? length / kStemLength : length;
  return true;
}

/// A second stem's path from the heel of its crotch on, with its first ring where that is clear of
/// its parent; empty if it is nowhere within `kStemReach` of its corner radii.
LimbPath leave_crotch(const LimbPath& child, const Hole& hole, const LimbHull& parent,
                      const LengthLimits& scale, int narrowing_steps) {
  LimbPath path;
  const double narrowing = std::pow(kStemFactor, narrowing_steps);
  const double margin =
      scale.smallest_gap + kNarrowingMargin * narrowing_steps * hole.parent_corner;
  const auto add = [&](double s) {
    path.points.push_back(position_at(child, s));
    path.corners.push_back(corner_at(child, s) * narrowing);
    path.bone_lengths.push_back(bone_length_at(child, s));
  };
  const double from = hole.crotch->child_end, corner = corner_at(child, from);
  const double gap = std::max(kStemGap * corner, 2.0 * scale.smallest_gap);
  const double last = std::min(from + kStemReach * corner, child.length() - gap);
  for (double s = from; s <= last; s += kStemStep * corner) {
    if (!ring_clears(parent, hole, position_at(child, s), direction_at(child, s),
                     corner_at(child, s) * narrowing, margin)) {
      continue;
    }
    add(hole.crotch->child_heel);
    add(s);
    for (size_t i = 1; i < child.points.size(); ++i) {
      if (child.lengths[i] < s + gap) continue;
      path.points.push_back(child.points[i]);
      path.corners.push_back(child.corners[i]);
      path.bone_lengths.push_back(child.bone_lengths[i]);
    }
    measure(path);
    path.clear_from = path.lengths[1];
    return path;
  }
  return path;
}

/// The joint of a child's first ring, and that ring's corner radius.
struct FirstRing {
  size_t joint = 0;
  double corner = 0.0;
};

/// The first joint whose ring, narrowed if necessary, clears the parent, or one soon after it whose
/// ring also rises from the hole. None: joint 0.
FirstRing first_ring(const LimbPath& child, const Hole& hole, const LimbHull& parent,
                     const LengthLimits& scale, double margin, double narrowing) {
  const size_t last = child.points.size() - 1;
  FirstRing first;
  for (size_t i = 1; i <= last; ++i) {
    if (first.joint > 0 && !is_shortcut(child, hole, first.joint, i)) {
      break;
    }
    const glm::dvec3 normal = joint_normal(child, i);
    for (double factor : {1.0, 0.75, 0.5, 0.3, 0.15, 0.0}) {
      if (i < last && factor < 0.5) {
        break;
      }
      const double corner = std::max(child.corners[i] * factor * narrowing, scale.smallest_corner);
      if (ring_clears(parent, hole, child.points[i], normal, corner, margin)) {
        const bool rises = ring_rises(hole, child.points[i], normal, corner);
        if (rises || first.joint == 0) {
          first = {i, corner};
        }
        if (rises) {
          return first;
        }
        break;
      }
    }
  }
  return first;
}

}  // namespace

Exit find_exit(const PathSearch& search, const PathSearch& own, double attach,
               const LimbPath& child, int32_t child_index, const LengthLimits& scale,
               int narrowing_steps) {
  const LimbPath& parent = search.path();
  const Crossing crossing = first_outside(search, child);
  Exit exit;
  exit.request.child = child_index;

  // The parent's sides are nearer to its centreline than its round hull: move back along the ray.
  double shift = crossing.parent_length - attach;
  if (!crossing.starts_outside) {
    shift *= kSideDistance;
  }
  exit.request.heading = attach + 3.0 * shift;
  const double reach = kLargestShift * corner_at(parent, attach);
  exit.request.position =
      std::clamp(attach + std::clamp(shift, -reach, reach), 0.0, parent.length());

  const Crossing out = first_outside(own, child);
  const glm::dvec3 axis = direction_at(own.path(), out.parent_length);
  glm::dvec3 off = across(out.point - position_at(own.path(), out.parent_length), axis);
  if (glm::length(off) <= scale.coincident) {
    off = across(child.points.back() - child.points.front(), axis);
  }
  if (glm::length(off) <= scale.coincident) {
    off = first_frame(axis).u;
  }
  exit.request.direction = glm::normalize(off);

  if (narrowing_steps <= kStemSteps &&
      leave_as_stem(search, attach, child, scale, narrowing_steps, exit)) {
    return exit;
  }
  const double side = 2.0 * kSideDistance * corner_at(parent, exit.request.position);
  const double wanted = 2.0 * kSideDistance * corner_at(child, crossing.child_length);
  const double widest = narrowing_steps == 0 ? kWidest * side : side;
  exit.clamped = wanted > 1.0001 * widest;
  exit.request.width = std::min(wanted, widest);
  exit.request.width *= narrowing_of(narrowing_steps, wanted, side);
  exit.request.width = std::max(exit.request.width, 2.0 * kSideDistance * scale.smallest_corner);
  exit.request.hole_length = exit.request.width;
  exit.request.length = exit.request.width < kInsetHoleBelow * side
                            ? std::min(exit.request.width / kHoleLength, side)
                            : exit.request.width;
  return exit;
}

LimbPath leave_parent(const LimbPath& child, const Hole& hole, const LimbHull& parent,
                      const LengthLimits& scale, int narrowing_steps) {
  if (hole.crotch) {
    LimbPath stem = leave_crotch(child, hole, parent, scale, narrowing_steps);
    if (!stem.points.empty()) return stem;
  }
  const double margin =
      scale.smallest_gap + kNarrowingMargin * narrowing_steps * hole.parent_corner;
  const double start_corner = corner_at(child, nearest_length(child, hole.centre));
  const double narrowing = narrowing_of(narrowing_steps, start_corner, hole.parent_corner);
  const size_t last = child.points.size() - 1;
  auto [first, first_corner] = first_ring(child, hole, parent, scale, margin, narrowing);
  glm::dvec3 first_point = child.points[first];
  if (first == 0) {
    // The whole branch is inside its parent, or behind it: a stub remains.
    first = last;
    first_corner =
        std::max(scale.smallest_corner, std::min(child.corners[last], 0.5 * hole.corner));
    first_point = hole.centre + hole.normal * std::max(hole.corner, 2.0 * scale.smallest_gap);
  }

  LimbPath path;
  const double start = std::min(nearest_length(child, hole.centre), 0.999 * child.lengths[first]);
  path.points.push_back(hole.centre);
  path.corners.push_back(hole.corner);
  path.bone_lengths.push_back(start);
  path.points.push_back(first_point);
  path.corners.push_back(first_corner);
  path.bone_lengths.push_back(child.bone_lengths[first]);
  path.points.insert(path.points.end(),
                     child.points.begin() + static_cast<std::ptrdiff_t>(first) + 1,
                     child.points.end());
  path.corners.insert(path.corners.end(),
                      child.corners.begin() + static_cast<std::ptrdiff_t>(first) + 1,
                      child.corners.end());
  path.bone_lengths.insert(path.bone_lengths.end(),
                           child.bone_lengths.begin() + static_cast<std::ptrdiff_t>(first) + 1,
                           child.bone_lengths.end());
  measure(path);
  path.clear_from = path.lengths[1];
  const glm::dvec3 direction = glm::normalize(path.points[1] - path.points[0]);
  for (double t : {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9}) {
    const double s = t * path.lengths[1];
    const double corner = hole.corner + (path.corners[1] - hole.corner) * t;
    const glm::dvec3 centre = path.points[0] + direction * s;
    if (ring_clears(parent, hole, centre, direction, corner, margin) &&
        ring_rises(hole, centre, direction, corner)) {
      path.clear_from = s;
      break;
    }
  }
  for (size_t i = 1; i < path.points.size(); ++i) {
    path.corners[i] =
        std::min(path.corners[i], hole.corner + kWidening * narrowing * path.lengths[i]);
  }
  return path;
}

}  // namespace snowbough::tree
