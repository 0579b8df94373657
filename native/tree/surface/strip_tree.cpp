#include "tree/surface/strip_tree.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace snowbough::tree {
namespace {

/// Segments per leaf.
constexpr int32_t kLeafSize = 4;
/// Relative to the largest coordinate.
constexpr double kRounding = 1e-11;

double distance_to_chord(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& point) {
  const glm::dvec3 ab = b - a;
  const double square = glm::dot(ab, ab);
  const double t = square > 0.0 ? std::clamp(glm::dot(point - a, ab) / square, 0.0, 1.0) : 0.0;
  return glm::distance(point, a + ab * t);
}

}  // namespace

StripTree::StripTree(const std::vector<glm::dvec3>& points) : points_(points) {
  if (points_.size() < 2) {
    return;
  }
  for (const glm::dvec3& p : points_) {
    rounding_ = std::max({rounding_, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  }
  rounding_ *= kRounding;
  add_node(0, static_cast<int32_t>(points_.size()) - 1);
}

int32_t StripTree::add_node(int32_t begin, int32_t end) {
  Node node;
  node.begin = begin;
  node.end = end;
  // The distance from a chord is convex: along a segment it is largest at an end.
  for (int32_t i = begin; i <= end; ++i) {
    node.stray = std::max(node.stray, distance_to_chord(points_[begin], points_[end], points_[i]));
  }
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

double StripTree::least_distance(const Node& node, const glm::dvec3& point) const {
  return distance_to_chord(points_[node.begin], points_[node.end], point) - node.stray;
}

}  // namespace snowbough::tree
