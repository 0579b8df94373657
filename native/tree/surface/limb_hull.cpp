#include "tree/surface/limb_hull.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

namespace snowbough::tree {
namespace {

/// Segments that are looked at one by one.
constexpr int32_t kLeafSize = 4;
/// Rounding of distances, as a share of the largest coordinate; far above what it is.
constexpr double kRounding = 1e-11;

double distance_to_segment(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& point,
                           double& t) {
  const glm::dvec3 ab = b - a;
  const double square = glm::dot(ab, ab);
  t = square > 0.0 ? std::clamp(glm::dot(point - a, ab) / square, 0.0, 1.0) : 0.0;
  return glm::distance(point, a + ab * t);
}

}  // namespace

LimbHull::LimbHull(const std::vector<Ring>& rings) {
  if (rings.size() < 2) {
    return;
  }
  for (const Ring& ring : rings) {
    centres_.push_back(ring.centre);
    corners_.push_back(ring.corner);
    for (int k = 0; k < 3; ++k) {
      slack_ = std::max(slack_, std::abs(ring.centre[k]) + ring.corner);
    }
  }
  slack_ *= kRounding;
  add_node(0, static_cast<int32_t>(rings.size()) - 1);
}

int32_t LimbHull::add_node(int32_t begin, int32_t end) {
  Node node;
  node.begin = begin;
  node.end = end;
  double thickest = 0.0;
  // Distance from a straight line is convex: between two centres it is no larger than at one.
  for (int32_t i = begin; i <= end; ++i) {
    node.reach = std::max(node.reach, distance_to_chord(begin, end, centres_[i]));
    thickest = std::max(thickest, corners_[i]);
  }
  node.reach += thickest;
  const auto number = static_cast<int32_t>(nodes_.size());
  nodes_.push_back(node);
  if (end - begin > kLeafSize) {
    const int32_t middle = begin + (end - begin) / 2;
    add_node(begin, middle);
    const int32_t second = add_node(middle, end);
    nodes_[number].second = second;
  }
  return number;
}

double LimbHull::distance_to_chord(int32_t begin, int32_t end, const glm::dvec3& point) const {
  double t = 0.0;
  return distance_to_segment(centres_[begin], centres_[end], point, t);
}

double LimbHull::outside(const Node& node, const glm::dvec3& point) const {
  return distance_to_chord(node.begin, node.end, point) - node.reach;
}

bool LimbHull::segment_clears(int32_t segment, const glm::dvec3& point, double margin) const {
  double t = 0.0;
  const double distance = distance_to_segment(centres_[segment], centres_[segment + 1], point, t);
  const double corner = corners_[segment] + (corners_[segment + 1] - corners_[segment]) * t;
  return distance - corner > margin;
}

bool LimbHull::clears(const glm::dvec3& point, double margin) const {
  if (nodes_.empty() || outside(nodes_.front(), point) > margin + slack_) {
    return true;
  }
  // Deeper than a tree over all rings that 31 bits can number.
  int32_t waiting[64];
  int count = 0;
  waiting[count++] = 0;
  while (count > 0) {
    const int32_t number = waiting[--count];
    const Node& node = nodes_[number];
    if (node.second == 0) {
      for (int32_t i = node.begin; i < node.end; ++i) {
        if (!segment_clears(i, point, margin)) {
          return false;
        }
      }
      continue;
    }
    // The nearer half first: if one does not clear, it is likely there.
    std::pair<double, int32_t> near(outside(nodes_[number + 1], point), number + 1);
    std::pair<double, int32_t> far(outside(nodes_[node.second], point), node.second);
    if (far < near) {
      std::swap(near, far);
    }
    for (const auto& [distance, half] : {far, near}) {
      if (distance <= margin + slack_) {
        waiting[count++] = half;
      }
    }
  }
  return true;
}

}  // namespace snowbough::tree
