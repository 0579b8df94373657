#include "tree/segment_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <tuple>
#include <utility>

namespace snowbough::tree {
namespace {

constexpr int32_t kLeafSize = 8;
/// Weight of the distance to the centreline beside that to the surface.
constexpr double kInsideShare = 0.05;

double box_distance(const glm::vec3& low, const glm::vec3& high, const glm::vec3& point) {
  const glm::dvec3 outside =
      glm::max(glm::max(glm::dvec3(low) - glm::dvec3(point), glm::dvec3(point) - glm::dvec3(high)),
               glm::dvec3(0.0));
  return glm::length(outside);
}

}  // namespace

SegmentTree::SegmentTree(const std::vector<Branch>& branches, std::vector<int32_t> order,
                         float radius_floor)
    : order_(std::move(order)), radius_floor_(radius_floor) {
  for (size_t b = 0; b < branches.size(); ++b) {
    const Branch& branch = branches[b];
    const size_t last = branch.points.size() == 1 ? 1 : branch.points.size() - 1;
    for (size_t i = 0; i < last && !branch.points.empty(); ++i) {
      const size_t j = std::min(i + 1, branch.points.size() - 1);
      segments_.push_back({branch.points[i], branch.points[j], branch.radii[i], branch.radii[j],
                           static_cast<int32_t>(b), static_cast<int32_t>(i)});
    }
  }
  if (!segments_.empty()) {
    nodes_.reserve(segments_.size() / 2 + 1);
    build(0, static_cast<int32_t>(segments_.size()));
  }
}

int32_t SegmentTree::build(int32_t begin, int32_t end) {
  const auto number = static_cast<int32_t>(nodes_.size());
  Node node{};
  node.low = glm::vec3(std::numeric_limits<float>::max());
  node.high = glm::vec3(std::numeric_limits<float>::lowest());
  node.smallest_order = std::numeric_limits<int32_t>::max();
  for (int32_t i = begin; i < end; ++i) {
    const Segment& s = segments_[i];
    node.low = glm::min(node.low, glm::min(s.a, s.b));
    node.high = glm::max(node.high, glm::max(s.a, s.b));
    node.largest_radius = std::max(node.largest_radius, std::max(s.radius_a, s.radius_b));
    node.smallest_order = std::min(node.smallest_order, order_[s.branch]);
  }
  node.begin = begin;
  node.end = end;
  node.leaf = end - begin <= kLeafSize;
  nodes_.push_back(node);
  if (!node.leaf) {
    const glm::vec3 size = node.high - node.low;
    int axis = size.y > size.x ? 1 : 0;
    if (size.z > size[axis]) axis = 2;
    const int32_t middle = begin + (end - begin) / 2;
    std::nth_element(segments_.begin() + begin, segments_.begin() + middle, segments_.begin() + end,
                     [axis](const Segment& s, const Segment& t) {
                       const float ms = s.a[axis] + s.b[axis];
                       const float mt = t.a[axis] + t.b[axis];
                       return std::tie(ms, s.branch, s.segment) < std::tie(mt, t.branch, t.segment);
                     });
    const int32_t left = build(begin, middle);
    const int32_t right = build(middle, end);
    nodes_[number].begin = left;
    nodes_[number].end = right;
  }
  return number;
}

NearestSegment SegmentTree::nearest(const glm::vec3& point, int32_t below_order, Measure measure,
                                    const std::vector<char>* excluded, double limit) const {
  NearestSegment best;
  best.cost = limit;
  const auto cost_of = [&](double distance, double radius) {
    switch (measure) {
      case Measure::kRadii:
        return distance / (radius + radius_floor_);
      case Measure::kSurface:
        return std::max(distance - radius, 0.0) + kInsideShare * distance;
      default:
        return distance;
    }
  };
  const auto bound = [&](const Node& node) {
    if (node.smallest_order >= below_order) return std::numeric_limits<double>::infinity();
    // A rounding error must not hide what lies exactly as near as the best.
    return (1.0 - 1e-9) * cost_of(box_distance(node.low, node.high, point), node.largest_radius);
  };
  // The stack never holds more than one sibling a level, and the tree is balanced.
  std::array<std::pair<double, int32_t>, 128> stack;
  size_t depth = 0;
  if (!nodes_.empty()) stack[depth++] = {bound(nodes_[0]), 0};
  while (depth > 0) {
    const auto [lower, number] = stack[--depth];
    if (lower > best.cost || std::isinf(lower)) continue;
    const Node& node = nodes_[number];
    if (!node.leaf) {
      std::pair<double, int32_t> near{bound(nodes_[node.begin]), node.begin};
      std::pair<double, int32_t> far{bound(nodes_[node.end]), node.end};
      if (far < near) std::swap(near, far);
      stack[depth++] = far;
      stack[depth++] = near;
      continue;
    }
    for (int32_t i = node.begin; i < node.end; ++i) {
      const Segment& s = segments_[i];
      if (order_[s.branch] >= below_order) continue;
      if (excluded != nullptr && (*excluded)[s.branch]) continue;
      const glm::dvec3 a(s.a);
      const glm::dvec3 along = glm::dvec3(s.b) - a;
      const double squared = glm::dot(along, along);
      const double t = squared > 0.0
                           ? std::clamp(glm::dot(glm::dvec3(point) - a, along) / squared, 0.0, 1.0)
                           : 0.0;
      const glm::dvec3 foot = a + t * along;
      const double distance = glm::length(glm::dvec3(point) - foot);
      const auto radius = static_cast<float>(s.radius_a + t * (s.radius_b - s.radius_a));
      const double cost = cost_of(distance, radius);
      if (cost < best.cost || (cost == best.cost && std::tie(s.branch, s.segment) <
                                                        std::tie(best.branch, best.segment))) {
        best = {s.branch,
                s.segment,
                static_cast<float>(t),
                glm::vec3(foot),
                static_cast<float>(distance),
                radius,
                cost};
      }
    }
  }
  return best;
}

}  // namespace snowbough::tree
