#include "tree/skeleton/simplify.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <vector>

#include "tree/skeleton/centreline.h"
#include "tree/skeleton/width.h"

namespace snowbough::tree {
namespace {

/// Change of thickness from which a ring is kept, in local radii and relative to the tolerance.
constexpr float kBulge = 0.05f;
constexpr size_t kFewestBulges = 4;

/// The branch with its children's attach points as points.
struct Refined {
  Branch branch;
  /// Per point: whether a child sits there.
  std::vector<bool> has_child;
  /// Per child, in input order: its point.
  std::vector<size_t> child_point;
};

Refined insert_attach_points(const Branch& branch, const std::vector<CentrelinePlace>& places) {
  // Sorted from root to tip; coincident places share a point.
  std::vector<size_t> order(places.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  const auto key = [&](size_t i) { return std::pair(places[i].segment, places[i].t); };
  std::stable_sort(order.begin(), order.end(), [&](size_t i, size_t j) { return key(i) < key(j); });

  Refined refined;
  refined.child_point.resize(places.size());
  const auto add = [&](const CentrelinePlace& place) {
    refined.branch.points.push_back(place.point);
    refined.branch.radii.push_back(radius_at(branch, place));
    refined.branch.areas.push_back(area_at(branch, place));
    refined.has_child.push_back(false);
  };
  const auto take_child = [&](size_t child) {
    refined.has_child.back() = true;
    refined.child_point[child] = refined.branch.points.size() - 1;
  };
  size_t next = 0;
  for (size_t i = 0; i < branch.points.size(); ++i) {
    refined.branch.points.push_back(branch.points[i]);
    refined.branch.radii.push_back(branch.radii[i]);
    refined.branch.areas.push_back(branch.areas[i]);
    refined.has_child.push_back(false);
    while (next < order.size() && i > 0 && places[order[next]].segment == i - 1) {
      take_child(order[next++]);
    }
    while (next < order.size() && places[order[next]].segment == i) {
      const CentrelinePlace& place = places[order[next]];
      // At the segment's far end it sits at the next point, which is not there yet.
      if (i + 1 < branch.points.size() && place.point == branch.points[i + 1]) break;
      if (place.point != refined.branch.points.back()) add(place);
      take_child(order[next++]);
    }
  }
  return refined;
}

/// A limb's thickness at a place, as two radii that are interpolated along a segment: the mean
/// distance of the ring's vertices, and the radius of a circle with the ring's area, on which the
/// surface is built.
struct Thickness {
  double radius;
  double area_radius;
};

Thickness thickness_of(const Branch& branch, size_t i) {
  return {branch.radii[i], std::sqrt(branch.areas[i] / std::numbers::pi)};
}

Thickness mix(const Thickness& a, const Thickness& b, double t) {
  return {a.radius + (b.radius - a.radius) * t,
          a.area_radius + (b.area_radius - a.area_radius) * t};
}

/// A straight bone between two points of a branch, as a round cone.
struct Chord {
  glm::dvec3 from;
  glm::dvec3 along;
  double squared;
  Thickness begin, end;

  Chord(const Branch& branch, size_t first, size_t last)
      : from(branch.points[first]),
        along(glm::dvec3(branch.points[last]) - from),
        squared(glm::dot(along, along)),
        begin(thickness_of(branch, first)),
        end(thickness_of(branch, last)) {}

  double foot(const glm::dvec3& point) const {
    return squared > 0.0 ? glm::dot(point - from, along) / squared : 0.0;
  }

  /// Maximum distance of the limb's surface around `point` from the cone's: the two circles' offset
  /// plus the difference of their radii.
  double miss(const glm::dvec3& point, const Thickness& thickness) const {
    const double t = std::clamp(foot(point), 0.0, 1.0);
    const Thickness cone = mix(begin, end, t);
    return glm::length(point - from - t * along) +
           std::max(std::abs(thickness.radius - cone.radius),
                    std::abs(thickness.area_radius - cone.area_radius));
  }
};

/// The largest deviation of a chord between the points `first` and `last`, relative to the allowed
/// one.
struct Worst {
  double share = 0.0;
  size_t point = 0;
};

Worst worst_miss(const Branch& branch, float tolerance, float smallest_radius, size_t first,
                 size_t last) {
  const Chord chord(branch, first, last);
  Worst worst;
  const auto look = [&](size_t point, const glm::dvec3& position, const Thickness& thickness) {
    const double radius = std::max(thickness.radius, static_cast<double>(smallest_radius));
    const double share = chord.miss(position, thickness) / std::max(tolerance * radius, 1e-300);
    if (share > worst.share) worst = {share, point};
  };
  for (size_t i = first + 1; i < last; ++i) {
    look(i, branch.points[i], thickness_of(branch, i));
  }
  // Along a segment of the original the deviation is convex, so that its ends bound it, except
  // where the foot leaves an end of the chord.
  for (size_t i = first; i < last; ++i) {
    const glm::dvec3 a(branch.points[i]), b(branch.points[i + 1]);
    const double foot_a = chord.foot(a), foot_b = chord.foot(b);
    for (const double end : {0.0, 1.0}) {
      if ((foot_a - end) * (foot_b - end) >= 0.0) continue;
      const double t = (end - foot_a) / (foot_b - foot_a);
      look(i > first ? i : i + 1, a + (b - a) * t,
           mix(thickness_of(branch, i), thickness_of(branch, i + 1), t));
    }
  }
  return worst;
}

/// Marks the points between two kept ones from which the chord would deviate too much.
void keep_needed_points(const Branch& branch, float tolerance, float smallest_radius, size_t first,
                        size_t last, std::vector<bool>& keep) {
  std::vector<std::pair<size_t, size_t>> open{{first, last}};
  while (!open.empty()) {
    const auto [from, to] = open.back();
    open.pop_back();
    if (to - from < 2) continue;
    const Worst worst = worst_miss(branch, tolerance, smallest_radius, from, to);
    if (worst.share <= 1.0) continue;
    keep[worst.point] = true;
    open.emplace_back(from, worst.point);
    open.emplace_back(worst.point, to);
  }
}

/// Marks the rings that bulge or narrow, if there are several as on a palm: the turns of the
/// thickness between which it changes by more than a small part of the tolerance. Bones could
/// bridge them, but the outline shows them.
void keep_bulges(const Branch& branch, float tolerance, std::vector<bool>& keep) {
  const std::vector<float>& radii = branch.radii;
  std::vector<size_t> turns{0};
  // The thickest or thinnest point since the last turn.
  size_t farthest = 0;
  for (size_t i = 1; i < radii.size(); ++i) {
    const float from_turn = radii[farthest] - radii[turns.back()];
    const float change = radii[i] - radii[farthest];
    if (from_turn * change > 0.0f) {
      farthest = i;
    } else if (std::abs(change) > kBulge * tolerance * radii[farthest]) {
      if (farthest != turns.back()) turns.push_back(farthest);
      farthest = i;
    }
  }
  if (turns.size() <= kFewestBulges) return;
  for (const size_t turn : turns) keep[turn] = true;
}

}  // namespace

void check_tolerance(float tolerance) {
  if (!std::isfinite(tolerance) || tolerance < 0.0f) {
    throw std::invalid_argument("tolerance must be a finite number of local radii, at least 0");
  }
}

void simplify_skeleton(Skeleton& skeleton, Simplify mode, float tolerance) {
  check_tolerance(tolerance);
  if (mode == Simplify::kNone) return;
  const float smallest_radius = kSmallestRadius * skeleton.height;
  std::vector<std::vector<int32_t>> children(skeleton.branches.size());
  for (size_t b = 0; b < skeleton.branches.size(); ++b) {
    const int32_t parent = skeleton.branches[b].parent;
    if (parent >= 0) children[parent].push_back(static_cast<int32_t>(b));
  }

  for (size_t b = 0; b < skeleton.branches.size(); ++b) {
    Branch& branch = skeleton.branches[b];
    if (children[b].empty() || branch.points.size() < 2) continue;
    std::vector<CentrelinePlace> places;
    for (const int32_t child : children[b]) {
      places.push_back(nearest_place(branch, skeleton.branches[child].attach_point));
    }
    const Refined refined = insert_attach_points(branch, places);
    const Branch& fine = refined.branch;
    for (size_t c = 0; c < children[b].size(); ++c) {
      skeleton.branches[children[b][c]].attach_point = fine.points[refined.child_point[c]];
    }

    std::vector<bool> keep = refined.has_child;
    keep.front() = true;
    const size_t last_child =
        *std::max_element(refined.child_point.begin(), refined.child_point.end());
    if (mode == Simplify::kTolerance || last_child == 0) keep.back() = true;
    if (mode == Simplify::kTolerance) {
      keep_bulges(fine, tolerance, keep);
      const std::vector<bool> fixed = keep;
      size_t from = 0;
      for (size_t i = 1; i < fine.points.size(); ++i) {
        if (!fixed[i]) continue;
        keep_needed_points(fine, tolerance, smallest_radius, from, i, keep);
        from = i;
      }
    }

    branch.points.clear();
    branch.radii.clear();
    branch.areas.clear();
    for (size_t i = 0; i < fine.points.size(); ++i) {
      if (!keep[i]) continue;
      branch.points.push_back(fine.points[i]);
      branch.radii.push_back(fine.radii[i]);
      branch.areas.push_back(fine.areas[i]);
    }
  }
}

}  // namespace snowbough::tree
