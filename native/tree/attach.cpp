#include "tree/attach.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <numeric>
#include <tuple>
#include <utility>

#include "tree/segment_tree.h"

namespace snowbough::tree {
namespace {

constexpr float kReachInRadii = 3.0f;
constexpr float kReachInSizes = 0.01f;
/// Floor of the radii in relative searches, as a share of the tree's size.
constexpr float kRadiusFloor = 1e-3f;

float largest_radius(const Branch& branch) {
  return *std::max_element(branch.radii.begin(), branch.radii.end());
}

float branch_length(const Branch& branch) {
  float length = 0.0f;
  for (size_t i = 1; i < branch.points.size(); ++i) {
    length += glm::distance(branch.points[i - 1], branch.points[i]);
  }
  return length;
}

/// Position in the row from the thickest to the thinnest branch.
std::vector<int32_t> thickness_order(const std::vector<Branch>& branches) {
  std::vector<std::tuple<float, float, int32_t>> keys;
  for (size_t b = 0; b < branches.size(); ++b) {
    keys.emplace_back(-largest_radius(branches[b]), -branch_length(branches[b]),
                      static_cast<int32_t>(b));
  }
  std::sort(keys.begin(), keys.end());
  std::vector<int32_t> order(branches.size());
  for (size_t i = 0; i < keys.size(); ++i) order[std::get<2>(keys[i])] = static_cast<int32_t>(i);
  return order;
}

bool reaches(const Branch& child, const NearestSegment& found, float size) {
  if (found.branch < 0) return false;
  return found.distance <=
         kReachInRadii * (found.radius + child.radii.front()) + kReachInSizes * size;
}

/// Feet of two stems side by side: the nearest point is the other's root and lies outside both
/// limbs.
bool stands_beside(const Branch& child, const Branch& parent, const NearestSegment& found) {
  return parent.parent < 0 && found.segment == 0 && found.t == 0.0f &&
         found.distance > found.radius + child.radii.front();
}

int32_t depth_of(const std::vector<Branch>& branches, int32_t branch) {
  int32_t depth = 0;
  while (branches[branch].parent >= 0) {
    branch = branches[branch].parent;
    ++depth;
  }
  return depth;
}

/// Reorders by level, keeping the input's order within one, and renumbers the parents.
void sort_by_level(std::vector<Branch>& branches) {
  std::vector<int32_t> order(branches.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](int32_t a, int32_t b) { return branches[a].level < branches[b].level; });
  std::vector<int32_t> number(branches.size());
  for (size_t i = 0; i < order.size(); ++i) number[order[i]] = static_cast<int32_t>(i);
  std::vector<Branch> sorted;
  sorted.reserve(branches.size());
  for (const int32_t b : order) {
    sorted.push_back(std::move(branches[b]));
    if (sorted.back().parent >= 0) sorted.back().parent = number[sorted.back().parent];
  }
  branches = std::move(sorted);
}

}  // namespace

std::vector<std::string> attach_branches(std::vector<Branch>& branches, float size) {
  if (branches.empty()) return {};
  const bool by_level = branches.front().level >= 0;
  std::vector<int32_t> order;
  if (by_level) {
    for (const Branch& branch : branches) order.push_back(branch.level);
  } else {
    order = thickness_order(branches);
  }
  const SegmentTree segments(branches, order, kRadiusFloor * size);

  // Thick before thin, so that a candidate's own parent is known when it is judged.
  std::vector<int32_t> sequence(branches.size());
  std::iota(sequence.begin(), sequence.end(), 0);
  std::stable_sort(sequence.begin(), sequence.end(),
                   [&](int32_t a, int32_t b) { return order[a] < order[b]; });
  for (const int32_t b : sequence) {
    Branch& branch = branches[b];
    const NearestSegment found = segments.nearest(branch.points.front(), order[b], !by_level);
    branch.parent = -1;
    branch.attach_point = branch.points.front();
    if (reaches(branch, found, size) && !stands_beside(branch, branches[found.branch], found)) {
      branch.parent = found.branch;
      branch.attach_point = found.point;
    }
  }
  if (!by_level) {
    for (size_t b = 0; b < branches.size(); ++b) {
      branches[b].level = depth_of(branches, static_cast<int32_t>(b));
    }
  }
  sort_by_level(branches);

  std::vector<std::string> extra_roots;
  for (size_t b = 1; b < branches.size(); ++b) {
    if (branches[b].parent < 0) extra_roots.push_back(branches[b].name);
  }
  return extra_roots;
}

}  // namespace snowbough::tree
