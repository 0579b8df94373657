#include "tree/skeleton/attach.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

#include "tree/skeleton/centreline.h"
#include "tree/skeleton/segment_tree.h"

namespace snowbough::tree {
namespace {

constexpr float kReachInRadii = 3.0f;
constexpr float kReachInSizes = 0.01f;
/// Reach to a lower level, relative to that to the own level, of a branch that attaches to neither
/// at first: names are better evidence than a slightly smaller distance.
constexpr float kReachToLevel = 2.0f;
/// Minimum radius in relative searches, as a fraction of the tree's size.
constexpr float kRadiusFloor = 1e-3f;

float largest_radius(const Branch& branch) {
  return *std::max_element(branch.radii.begin(), branch.radii.end());
}

/// Rank of each branch from the thickest to the thinnest.
std::vector<int32_t> thickness_order(const std::vector<Branch>& branches) {
  std::vector<std::tuple<float, float, int32_t>> keys;
  for (size_t b = 0; b < branches.size(); ++b) {
    keys.emplace_back(-largest_radius(branches[b]), -polyline_length(branches[b].points),
                      static_cast<int32_t>(b));
  }
  std::sort(keys.begin(), keys.end());
  std::vector<int32_t> order(branches.size());
  for (size_t i = 0; i < keys.size(); ++i) order[std::get<2>(keys[i])] = static_cast<int32_t>(i);
  return order;
}

/// @param share  of the usual reach.
bool reaches(float radius, const NearestSegment& found, float size, float share = 1.0f) {
  if (found.branch < 0) return false;
  return found.distance <= share * (kReachInRadii * (found.radius + radius) + kReachInSizes * size);
}

bool touches(float radius, const NearestSegment& found) {
  return found.branch >= 0 && found.distance <= found.radius + radius;
}

/// Whether two stems stand side by side: the nearest point is the other's root and outside both
/// limbs.
bool stands_beside(const Branch& child, const Branch& parent, const NearestSegment& found) {
  return parent.parent < 0 && found.point == parent.points.front() &&
         !touches(child.radii.front(), found);
}

void reverse_branch(Branch& branch) {
  std::reverse(branch.points.begin(), branch.points.end());
  std::reverse(branch.radii.begin(), branch.radii.end());
  std::reverse(branch.areas.begin(), branch.areas.end());
}

int32_t depth_of(const std::vector<Branch>& branches, int32_t branch) {
  int32_t depth = 0;
  while (branches[branch].parent >= 0) {
    branch = branches[branch].parent;
    ++depth;
  }
  return depth;
}

/// Sorts by level, then depth, stable, and renumbers the parents.
void sort_branches(std::vector<Branch>& branches, std::vector<char>& reversible) {
  std::vector<int32_t> depth(branches.size());
  for (size_t b = 0; b < branches.size(); ++b)
    depth[b] = depth_of(branches, static_cast<int32_t>(b));
  std::vector<int32_t> order(branches.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int32_t a, int32_t b) {
    return std::pair(branches[a].level, depth[a]) < std::pair(branches[b].level, depth[b]);
  });
  std::vector<int32_t> number(branches.size());
  for (size_t i = 0; i < order.size(); ++i) number[order[i]] = static_cast<int32_t>(i);
  std::vector<Branch> sorted;
  std::vector<char> sorted_reversible;
  sorted.reserve(branches.size());
  for (const int32_t b : order) {
    sorted.push_back(std::move(branches[b]));
    if (sorted.back().parent >= 0) sorted.back().parent = number[sorted.back().parent];
    sorted_reversible.push_back(reversible[b]);
  }
  branches = std::move(sorted);
  reversible = std::move(sorted_reversible);
}

void take_parent(Branch& branch, const NearestSegment& found) {
  branch.parent = found.branch;
  branch.attach_point = found.point;
}

/// Branches that start at one place, or within one limb, are siblings: if a branch was attached at
/// another's root, or starts inside that one's parent, it gets that parent.
/// @param branches those thicker than the child already have their parents.
void prefer_common_parent(const std::vector<Branch>& branches, const Branch& child,
                          NearestSegment& found) {
  while (found.branch >= 0) {
    const Branch& sibling = branches[found.branch];
    if (sibling.parent < 0) return;
    const Branch& parent = branches[sibling.parent];
    CentrelinePlace place = nearest_place(parent, child.points.front());
    float away = glm::distance(child.points.front(), place.point);
    if (away > radius_at(parent, place)) {
      if (found.point != sibling.points.front()) return;
      place = nearest_place(parent, sibling.attach_point);
      away = glm::distance(child.points.front(), place.point);
      // No farther from the common parent than from the sibling, apart from the path through the
      // limb itself.
      if (away > found.distance + radius_at(parent, place)) return;
    }
    found.branch = sibling.parent;
    found.point = place.point;
    found.distance = away;
    found.radius = radius_at(parent, place);
  }
}

/// Attaches roots to a branch that was no candidate by reach, thickness or level, and does not
/// descend from them.
void attach_left_over(std::vector<Branch>& branches, const std::vector<int32_t>& order,
                      int32_t first, bool by_level, const SegmentTree& segments, float size) {
  std::vector<std::vector<int32_t>> children(branches.size());
  for (size_t b = 0; b < branches.size(); ++b) {
    if (branches[b].parent >= 0) children[branches[b].parent].push_back(static_cast<int32_t>(b));
  }
  std::vector<char> own(branches.size(), 0);
  for (size_t b = 0; b < branches.size(); ++b) {
    Branch& branch = branches[b];
    if (branch.parent >= 0 || static_cast<int32_t>(b) == first) continue;
    std::vector<int32_t> family{static_cast<int32_t>(b)};
    for (size_t i = 0; i < family.size(); ++i) {
      own[family[i]] = 1;
      for (const int32_t child : children[family[i]]) family.push_back(child);
    }
    const auto nearest = [&](int32_t below) {
      return segments.nearest(branch.points.front(), below,
                              by_level ? Measure::kDistance : Measure::kRadii, &own);
    };
    const auto takes = [&](const NearestSegment& found, float share) {
      return reaches(branch.radii.front(), found, size, share) &&
             !stands_beside(branch, branches[found.branch], found);
    };
    NearestSegment found;
    if (by_level) found = nearest(order[b]);
    if (!takes(found, kReachToLevel)) {
      found = nearest(by_level ? order[b] + 1 : std::numeric_limits<int32_t>::max());
      if (!takes(found, 1.0f)) found.branch = -1;
    }
    for (const int32_t member : family) own[member] = 0;
    if (found.branch < 0) continue;
    take_parent(branch, found);
    children[found.branch].push_back(static_cast<int32_t>(b));
  }
}

}  // namespace

void attach_branches(std::vector<Branch>& branches, std::vector<char>& reversible, float size,
                     const base::Progress& progress) {
  if (branches.empty()) return;
  const bool by_level = branches.front().level >= 0;
  std::vector<int32_t> order;
  if (by_level) {
    for (const Branch& branch : branches) order.push_back(branch.level);
  } else {
    order = thickness_order(branches);
  }
  // A branch that came with its parent cannot become a child of its descendants.
  for (size_t b = 0; b < branches.size(); ++b) {
    if (branches[b].parent >= 0) order[b] = std::max(order[b], order[branches[b].parent]);
  }
  const Measure measure = by_level ? Measure::kDistance : Measure::kRadii;
  const SegmentTree segments(branches, order, kRadiusFloor * size);

  // In order of decreasing thickness, so that a candidate's own parent is known.
  std::vector<int32_t> sequence(branches.size());
  std::iota(sequence.begin(), sequence.end(), 0);
  std::stable_sort(sequence.begin(), sequence.end(),
                   [&](int32_t a, int32_t b) { return order[a] < order[b]; });
  size_t done = 0;
  for (const int32_t b : sequence) {
    if ((done++ & 0xfff) == 0) {
      base::report_progress(progress,
                            static_cast<float>(done) / static_cast<float>(sequence.size()));
    }
    Branch& branch = branches[b];
    if (branch.parent >= 0) continue;
    NearestSegment found = segments.nearest(branch.points.front(), order[b], measure);
    if (reversible[b] && !touches(branch.radii.front(), found)) {
      const NearestSegment other = segments.nearest(branch.points.back(), order[b], measure);
      if (touches(branch.radii.back(), other)) {
        reverse_branch(branch);
        found = other;
      }
    }
    if (!by_level) prefer_common_parent(branches, branch, found);
    branch.parent = -1;
    branch.attach_point = branch.points.front();
    if (reaches(branch.radii.front(), found, size) &&
        !stands_beside(branch, branches[found.branch], found)) {
      take_parent(branch, found);
    }
  }
  attach_left_over(branches, order, sequence.front(), by_level, segments, size);
  if (!by_level) {
    for (size_t b = 0; b < branches.size(); ++b) {
      branches[b].level = depth_of(branches, static_cast<int32_t>(b));
    }
  }
  sort_branches(branches, reversible);
}

}  // namespace snowbough::tree
