#include "base/triangle_tree.h"

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numeric>
#include <utility>

namespace snowbough::base {
namespace {

constexpr int32_t kLeafSize = 4;

double squared(const glm::dvec3& v) {
  return glm::dot(v, v);
}

double squared_distance(const glm::vec3& low, const glm::vec3& high, const glm::dvec3& p) {
  return squared(p - glm::clamp(p, glm::dvec3(low), glm::dvec3(high)));
}

/// Whether a ray hits a box closer than `nearest`. `inverse`: 1 / direction.
bool meets(const glm::vec3& low, const glm::vec3& high, const glm::dvec3& from,
           const glm::dvec3& inverse, double nearest) {
  const glm::dvec3 a = (glm::dvec3(low) - from) * inverse, b = (glm::dvec3(high) - from) * inverse;
  const glm::dvec3 enters = glm::min(a, b), leaves = glm::max(a, b);
  const double enter = std::max({enters.x, enters.y, enters.z, 0.0});
  const double leave = std::min({leaves.x, leaves.y, leaves.z, nearest});
  return enter <= leave;
}

/// Distance along a ray to a triangle, or infinity.
double meets_triangle(const glm::dvec3& from, const glm::dvec3& direction,
                      const std::array<glm::vec3, 3>& corners) {
  constexpr double kMisses = std::numeric_limits<double>::infinity();
  const glm::dvec3 a(corners[0]), ab = glm::dvec3(corners[1]) - a, ac = glm::dvec3(corners[2]) - a;
  const glm::dvec3 across = glm::cross(direction, ac);
  const double determinant = glm::dot(ab, across);
  if (determinant == 0.0) return kMisses;
  const glm::dvec3 to_ray = from - a;
  const double u = glm::dot(to_ray, across) / determinant;
  if (!(u >= 0.0 && u <= 1.0)) return kMisses;
  const glm::dvec3 normal = glm::cross(to_ray, ab);
  const double v = glm::dot(direction, normal) / determinant;
  if (!(v >= 0.0 && u + v <= 1.0)) return kMisses;
  return glm::dot(ac, normal) / determinant;
}

}  // namespace

glm::dvec3 nearest_on_triangle(const glm::dvec3& p, const std::array<glm::dvec3, 3>& triangle) {
  const auto& [a, b, c] = triangle;
  const glm::dvec3 ab = b - a, ac = c - a;
  const double ab_a = glm::dot(ab, p - a), ac_a = glm::dot(ac, p - a);
  if (ab_a <= 0.0 && ac_a <= 0.0) return a;
  const double ab_b = glm::dot(ab, p - b), ac_b = glm::dot(ac, p - b);
  if (ab_b >= 0.0 && ac_b <= ab_b) return b;
  const double area_c = ab_a * ac_b - ab_b * ac_a;
  if (area_c <= 0.0 && ab_a >= 0.0 && ab_b <= 0.0) return a + ab * (ab_a / (ab_a - ab_b));
  const double ab_c = glm::dot(ab, p - c), ac_c = glm::dot(ac, p - c);
  if (ac_c >= 0.0 && ab_c <= ac_c) return c;
  const double area_b = ab_c * ac_a - ab_a * ac_c;
  if (area_b <= 0.0 && ac_a >= 0.0 && ac_c <= 0.0) return a + ac * (ac_a / (ac_a - ac_c));
  const double area_a = ab_b * ac_c - ab_c * ac_b;
  const double towards_c = ac_b - ab_b, towards_b = ab_c - ac_c;
  if (area_a <= 0.0 && towards_c >= 0.0 && towards_b >= 0.0) {
    return b + (c - b) * (towards_c / (towards_c + towards_b));
  }
  const double whole = area_a + area_b + area_c;
  return a + ab * (area_b / whole) + ac * (area_c / whole);
}

TriangleTree::TriangleTree(const std::vector<glm::vec3>& vertices,
                           const std::vector<std::array<int32_t, 3>>& triangles,
                           const std::vector<int32_t>& group_begin)
    : order_(triangles.size()) {
  for (const std::array<int32_t, 3>& t : triangles) {
    corners_.push_back({vertices[t[0]], vertices[t[1]], vertices[t[2]]});
  }
  std::iota(order_.begin(), order_.end(), 0);
  for (size_t g = 0; g + 1 < group_begin.size(); ++g) {
    const bool empty = group_begin[g] == group_begin[g + 1];
    roots_.push_back(empty ? -1 : static_cast<int32_t>(nodes_.size()));
    if (!empty) build(group_begin[g], group_begin[g + 1]);
  }
}

void TriangleTree::build(int32_t begin, int32_t end) {
  const auto number = nodes_.size();
  Box box{corners_[order_[begin]][0], corners_[order_[begin]][0]};
  Box centres{box.low + box.low + box.low, box.low + box.low + box.low};
  bool first = true;
  for (int32_t i = begin; i < end; ++i) {
    const auto& [a, b, c] = corners_[order_[i]];
    box.low = glm::min(box.low, glm::min(a, glm::min(b, c)));
    box.high = glm::max(box.high, glm::max(a, glm::max(b, c)));
    const glm::vec3 centre = a + b + c;
    centres.low = first ? centre : glm::min(centres.low, centre);
    centres.high = first ? centre : glm::max(centres.high, centre);
    first = false;
  }
  nodes_.push_back({box, begin, end, -1});
  if (end - begin <= kLeafSize) return;
  const glm::vec3 extent = centres.high - centres.low;
  int axis = extent.y > extent.x ? 1 : 0;
  if (extent.z > extent[axis]) axis = 2;
  const int32_t middle = begin + (end - begin) / 2;
  const auto key = [&](int32_t t) {
    return std::pair(corners_[t][0][axis] + corners_[t][1][axis] + corners_[t][2][axis], t);
  };
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                   [&](int32_t a, int32_t b) { return key(a) < key(b); });
  build(begin, middle);
  nodes_[number].second = static_cast<int32_t>(nodes_.size());
  build(middle, end);
}

TriangleTree::Nearest TriangleTree::nearest(int32_t group, const glm::dvec3& p) const {
  Nearest best;
  if (roots_[group] < 0) return best;
  // The tree's depth: each level halves the range.
  std::array<int32_t, 64> stack{};
  int32_t pending = 0;
  stack[pending++] = roots_[group];
  while (pending > 0) {
    const int32_t number = stack[--pending];
    const Node& node = nodes_[number];
    if (squared_distance(node.box.low, node.box.high, p) > best.squared_distance) continue;
    if (node.second < 0) {
      for (int32_t i = node.begin; i < node.end; ++i) {
        const auto& [a, b, c] = corners_[order_[i]];
        const glm::dvec3 point = nearest_on_triangle(p, {a, b, c});
        const double distance = squared(p - point);
        if (distance < best.squared_distance ||
            (distance == best.squared_distance && order_[i] < best.triangle)) {
          best = {order_[i], point, distance};
        }
      }
      continue;
    }
    const auto distance_to = [&](int32_t child) {
      return squared_distance(nodes_[child].box.low, nodes_[child].box.high, p);
    };
    const bool second_nearer = distance_to(node.second) < distance_to(number + 1);
    stack[pending++] = second_nearer ? number + 1 : node.second;
    stack[pending++] = second_nearer ? node.second : number + 1;
  }
  return best;
}

double TriangleTree::distance_along(int32_t group, const glm::dvec3& from,
                                    const glm::dvec3& direction, double least) const {
  double nearest = std::numeric_limits<double>::infinity();
  if (roots_[group] < 0) return nearest;
  // A direction of 0 meets the planes of its axis at infinity, never 0 / 0.
  glm::dvec3 inverse;
  for (int axis = 0; axis < 3; ++axis) {
    inverse[axis] = 1.0 / (direction[axis] == 0.0 ? 1e-300 : direction[axis]);
  }
  std::array<int32_t, 64> stack{};
  int32_t pending = 0;
  stack[pending++] = roots_[group];
  while (pending > 0) {
    const int32_t number = stack[--pending];
    const Node& node = nodes_[number];
    if (!meets(node.box.low, node.box.high, from, inverse, nearest)) continue;
    if (node.second < 0) {
      for (int32_t i = node.begin; i < node.end; ++i) {
        const double at = meets_triangle(from, direction, corners_[order_[i]]);
        if (at > least && at < nearest) nearest = at;
      }
      continue;
    }
    stack[pending++] = node.second;
    stack[pending++] = number + 1;
  }
  return nearest;
}

}  // namespace snowbough::base
