#include "base/triangle_tree.h"

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
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
  // The factor covers rounding: T. Ize, "Robust BVH Ray Traversal", 2013.
  return enter <= leave * (1.0 + 1e-12);
}

/// A ray in the shape in which triangles are tested: sheared so that it runs along one axis.
struct ShearedRay {
  glm::dvec3 from;
  std::array<int, 3> axis;
  glm::dvec2 shear;
  double scale;

  ShearedRay(const glm::dvec3& origin, const glm::dvec3& direction) : from(origin) {
    const glm::dvec3 size = glm::abs(direction);
    const int along = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
    axis = {(along + 1) % 3, (along + 2) % 3, along};
    shear = glm::dvec2(direction[axis[0]], direction[axis[1]]) / direction[along];
    scale = 1.0 / direction[along];
  }
  /// A corner relative to the ray, which runs along z.
  glm::dvec3 sheared(const glm::vec3& corner) const {
    const glm::dvec3 away = glm::dvec3(corner) - from;
    const double along = away[axis[2]];
    return {away[axis[0]] - shear.x * along, away[axis[1]] - shear.y * along, scale * along};
  }
};

/// Distance along a ray to a triangle, or infinity. Triangles that share an edge get the opposite
/// number for it, to the bit, so no ray passes between them.
double meets_triangle(const ShearedRay& ray, const std::array<glm::vec3, 3>& corners) {
  constexpr double kMisses = std::numeric_limits<double>::infinity();
  const glm::dvec3 a = ray.sheared(corners[0]);
  const glm::dvec3 b = ray.sheared(corners[1]);
  const glm::dvec3 c = ray.sheared(corners[2]);
  const double u = c.x * b.y - c.y * b.x;
  const double v = a.x * c.y - a.y * c.x;
  const double w = b.x * a.y - b.y * a.x;
  if ((u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0)) return kMisses;
  const double determinant = u + v + w;
  if (determinant == 0.0) return kMisses;
  return (u * a.z + v * b.z + w * c.z) / determinant;
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
  set_corners(vertices, triangles);
  std::iota(order_.begin(), order_.end(), 0);
  for (size_t g = 0; g + 1 < group_begin.size(); ++g) {
    const bool empty = group_begin[g] == group_begin[g + 1];
    roots_.push_back(empty ? -1 : static_cast<int32_t>(nodes_.size()));
    if (!empty) build(group_begin[g], group_begin[g + 1]);
  }
}

void TriangleTree::set_corners(const std::vector<glm::vec3>& vertices,
                               const std::vector<std::array<int32_t, 3>>& triangles) {
  corners_.resize(triangles.size());
  for (size_t i = 0; i < triangles.size(); ++i) {
    const auto& [a, b, c] = triangles[i];
    corners_[i] = {vertices[a], vertices[b], vertices[c]};
  }
}

void TriangleTree::refit(const std::vector<glm::vec3>& vertices,
                         const std::vector<std::array<int32_t, 3>>& triangles) {
  set_corners(vertices, triangles);
  // Children follow their parent.
  for (size_t number = nodes_.size(); number-- > 0;) {
    Node& node = nodes_[number];
    if (node.second < 0) {
      node.box = box_of(node.begin, node.end);
      continue;
    }
    const Box& first = nodes_[number + 1].box;
    const Box& second = nodes_[static_cast<size_t>(node.second)].box;
    node.box = {glm::min(first.low, second.low), glm::max(first.high, second.high)};
  }
}

TriangleTree::Box TriangleTree::box_of(int32_t begin, int32_t end) const {
  Box box{corners_[order_[begin]][0], corners_[order_[begin]][0]};
  for (int32_t i = begin; i < end; ++i) {
    for (const glm::vec3& corner : corners_[order_[i]]) {
      box = {glm::min(box.low, corner), glm::max(box.high, corner)};
    }
  }
  return box;
}

void TriangleTree::build(int32_t begin, int32_t end) {
  const auto number = nodes_.size();
  const auto centre_of = [&](int32_t i) {
    const auto& [a, b, c] = corners_[order_[i]];
    return a + b + c;
  };
  Box centres{centre_of(begin), centre_of(begin)};
  for (int32_t i = begin; i < end; ++i) {
    centres = {glm::min(centres.low, centre_of(i)), glm::max(centres.high, centre_of(i))};
  }
  nodes_.push_back({box_of(begin, end), begin, end, -1});
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

TriangleTree::Nearest TriangleTree::nearest(int32_t group, const glm::dvec3& p,
                                            int32_t hint) const {
  Nearest best;
  if (roots_[group] < 0) return best;
  const auto compare = [&](int32_t triangle) {
    const auto& [a, b, c] = corners_[triangle];
    const glm::dvec3 point = nearest_on_triangle(p, {a, b, c});
    const double distance = squared(p - point);
    if (distance < best.squared_distance ||
        (distance == best.squared_distance && triangle < best.triangle)) {
      best = {triangle, point, distance};
    }
  };
  if (hint >= 0) compare(hint);
  // The tree's depth: each level halves the range.
  std::array<int32_t, 64> stack{};
  int32_t pending = 0;
  stack[pending++] = roots_[group];
  while (pending > 0) {
    const int32_t number = stack[--pending];
    const Node& node = nodes_[number];
    if (squared_distance(node.box.low, node.box.high, p) > best.squared_distance) continue;
    if (node.second < 0) {
      for (int32_t i = node.begin; i < node.end; ++i) compare(order_[i]);
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

TriangleTree::Hit TriangleTree::first_along(int32_t group, const glm::dvec3& from,
                                            const glm::dvec3& direction, double least,
                                            double most) const {
  Hit first{-1, most};
  if (roots_[group] < 0) return {};
  const ShearedRay ray(from, direction);
  // A direction of 0 meets the planes of its axis at infinity, never 0 / 0.
  glm::dvec3 inverse;
  for (int axis = 0; axis < 3; ++axis) {
    inverse[axis] = 1.0 / (direction[axis] == 0.0 ? 1e-300 : direction[axis]);
  }
  std::array<int32_t, 64> stack;
  int32_t pending = 0;
  stack[pending++] = roots_[group];
  while (pending > 0) {
    const int32_t number = stack[--pending];
    const Node& node = nodes_[number];
    if (!meets(node.box.low, node.box.high, from, inverse, first.distance)) continue;
    if (node.second < 0) {
      for (int32_t i = node.begin; i < node.end; ++i) {
        const double at = meets_triangle(ray, corners_[order_[i]]);
        if (!(at > least)) continue;
        const bool is_first =
            at < first.distance || (at == first.distance && order_[i] < first.triangle);
        if (is_first) first = {order_[i], at};
      }
      continue;
    }
    // The nearer child first.
    const Box& one = nodes_[number + 1].box;
    const Box& other = nodes_[node.second].box;
    double ahead = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      ahead += direction[axis] * static_cast<double>(other.low[axis] + other.high[axis] -
                                                     one.low[axis] - one.high[axis]);
    }
    stack[pending++] = ahead < 0.0 ? number + 1 : node.second;
    stack[pending++] = ahead < 0.0 ? node.second : number + 1;
  }
  return first.triangle < 0 ? Hit{} : first;
}

}  // namespace snowbough::base
