#pragma once

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <numeric>
#include <random>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "tree/skeleton/skeleton.h"

namespace snowbough::tree {

/// A limb whose place in the tree is known: straight from its root on.
struct GrownLimb {
  int32_t parent = -1;
  glm::vec3 root{0.0f}, tip{0.0f};
  float radius = 0.1f;

  glm::vec3 at(float share) const { return root + share * (tip - root); }
  float radius_at(float share) const { return radius * (1.0f - 0.6f * share); }
};

/// A trunk of 8 m, `limbs` limbs around it and `twigs` twigs on each of them.
inline std::vector<GrownLimb> grow_limbs(int limbs, int twigs) {
  std::vector<GrownLimb> tree{{-1, {0, 0, 0}, {0, 0, 8}, 0.3f}};
  for (int i = 0; i < limbs; ++i) {
    const float angle = 2.4f * static_cast<float>(i);
    const float share = 0.25f + 0.6f * static_cast<float>(i) / static_cast<float>(limbs);
    const glm::vec3 root = tree[0].at(share);
    const glm::vec3 way(std::cos(angle), std::sin(angle), 0.4f);
    tree.push_back({0, root, root + 2.5f * way, 0.5f * tree[0].radius_at(share)});
  }
  for (int i = 1; i <= limbs; ++i) {
    for (int j = 0; j < twigs; ++j) {
      const float share = 0.35f + 0.55f * static_cast<float>(j) / static_cast<float>(twigs);
      const glm::vec3 along = glm::normalize(tree[i].tip - tree[i].root);
      const glm::vec3 side =
          glm::normalize(glm::cross(along, glm::vec3(0, 0, 1))) * (j % 2 == 0 ? 1.0f : -1.0f);
      const glm::vec3 root = tree[i].at(share);
      tree.push_back(
          {i, root, root + 0.8f * glm::normalize(side + along), 0.5f * tree[i].radius_at(share)});
    }
  }
  return tree;
}

/// Triangles whose vertices and faces come in an order that a seed determines.
class TriangleSoup {
 public:
  int32_t add_vertex(const glm::vec3& p) {
    vertices_.push_back(p);
    return static_cast<int32_t>(vertices_.size()) - 1;
  }
  void add_triangle(int32_t a, int32_t b, int32_t c) { triangles_.push_back({a, b, c}); }
  size_t triangle_count() const { return triangles_.size(); }

  /// A tube of rings with these numbers of corners, open at its root and closed by a tip.
  void add_tube(const GrownLimb& limb, const std::vector<int>& corners) {
    const glm::vec3 axis = glm::normalize(limb.tip - limb.root);
    const glm::vec3 across = std::abs(axis.z) < 0.9f ? glm::vec3(0, 0, 1) : glm::vec3(1, 0, 0);
    const glm::vec3 u = glm::normalize(glm::cross(axis, across));
    const glm::vec3 w = glm::cross(axis, u);
    std::vector<int32_t> below;
    for (size_t i = 0; i < corners.size(); ++i) {
      const float share = static_cast<float>(i) / static_cast<float>(corners.size());
      std::vector<int32_t> ring;
      for (int k = 0; k < corners[i]; ++k) {
        const double angle = 2.0 * M_PI * k / corners[i] + 0.2 * static_cast<double>(i);
        ring.push_back(add_vertex(limb.at(share) + limb.radius_at(share) *
                                                       (static_cast<float>(std::cos(angle)) * u +
                                                        static_cast<float>(std::sin(angle)) * w)));
      }
      if (i > 0) add_belt(below, ring);
      below = std::move(ring);
    }
    const int32_t tip = add_vertex(limb.tip);
    for (size_t k = 0; k < below.size(); ++k) {
      add_triangle(below[k], below[(k + 1) % below.size()], tip);
    }
  }

  std::string text(uint32_t seed) const {
    std::mt19937 random(seed);
    std::vector<int32_t> order(vertices_.size());
    std::iota(order.begin(), order.end(), 0);
    std::shuffle(order.begin(), order.end(), random);
    std::vector<int32_t> number(order.size());
    for (size_t i = 0; i < order.size(); ++i) number[order[i]] = static_cast<int32_t>(i) + 1;
    std::vector<std::array<int32_t, 3>> triangles = triangles_;
    std::shuffle(triangles.begin(), triangles.end(), random);
    return write(order, number, triangles);
  }

  /// The limbs as they were made.
  std::string in_order() const {
    std::vector<int32_t> order(vertices_.size());
    std::iota(order.begin(), order.end(), 0);
    std::vector<int32_t> number(order.size());
    std::iota(number.begin(), number.end(), 1);
    return write(order, number, triangles_);
  }

 private:
  std::string write(const std::vector<int32_t>& order, const std::vector<int32_t>& number,
                    const std::vector<std::array<int32_t, 3>>& triangles) const {
    std::ostringstream text;
    text.precision(9);
    for (const int32_t v : order) {
      text << "v " << vertices_[v].x << " " << vertices_[v].y << " " << vertices_[v].z << "\n";
    }
    for (const auto& [a, b, c] : triangles) {
      text << "f " << number[a] << " " << number[b] << " " << number[c] << "\n";
    }
    return text.str();
  }

  /// Triangles between two rings of different numbers of corners.
  void add_belt(const std::vector<int32_t>& low, const std::vector<int32_t>& high) {
    const size_t m = low.size();
    const size_t n = high.size();
    for (size_t i = 0, j = 0; i < m || j < n;) {
      if (j == n || (i < m && (i + 1) * n <= (j + 1) * m)) {
        add_triangle(low[i % m], low[(i + 1) % m], high[j % n]);
        ++i;
      } else {
        add_triangle(low[i % m], high[(j + 1) % n], high[j % n]);
        ++j;
      }
    }
  }

  std::vector<glm::vec3> vertices_;
  std::vector<std::array<int32_t, 3>> triangles_;
};

/// The limbs as 3ds Max's foliage has them: one tube each, of triangles, with fewer and fewer
/// corners.
inline TriangleSoup foliage_tubes(const std::vector<GrownLimb>& limbs) {
  TriangleSoup soup;
  for (const GrownLimb& limb : limbs) {
    const bool trunk = limb.parent < 0;
    const bool twig = limb.parent > 0;
    const int first = trunk ? 8 : twig ? 4 : 6;
    const int rings = trunk ? 36 : twig ? 4 : 9;
    std::vector<int> corners;
    for (int i = 0; i < rings; ++i) {
      corners.push_back(std::max(3, first - i * (first - 2) / rings));
    }
    soup.add_tube(limb, corners);
  }
  return soup;
}

/// One closed surface around all limbs, as a scan has it: where `field`, a distance, is zero, by
/// marching tetrahedra on a grid with cells of `cell` metres.
///
/// Source: A. Doi, A. Koide, "An efficient method of triangulating equi-valued surfaces by using
/// tetrahedral cells", IEICE Transactions E74, 1991.
inline TriangleSoup marched_surface(const std::function<float(const glm::vec3&)>& field,
                                    const glm::vec3& low, const glm::vec3& high, float cell) {
  const glm::ivec3 count = glm::ivec3((high - low) / cell) + 2;
  const auto number = [&](const glm::ivec3& c) { return (c.z * count.y + c.y) * count.x + c.x; };
  const auto place = [&](const glm::ivec3& c) { return low + cell * glm::vec3(c); };
  std::vector<float> values(static_cast<size_t>(count.x) * count.y * count.z);
  // Blocks far from the surface take the value of their middle: nothing is found there.
  constexpr int kBlock = 8;
  const float far = 1.1f * kBlock * cell;
  for (int z = 0; z < count.z; z += kBlock) {
    for (int y = 0; y < count.y; y += kBlock) {
      for (int x = 0; x < count.x; x += kBlock) {
        const float middle = field(place({x, y, z}) + 0.5f * kBlock * cell);
        for (int i = 0; i < kBlock * kBlock * kBlock; ++i) {
          const glm::ivec3 c(x + i % kBlock, y + i / kBlock % kBlock, z + i / kBlock / kBlock);
          if (c.x >= count.x || c.y >= count.y || c.z >= count.z) continue;
          const float value = std::abs(middle) > far ? middle : field(place(c));
          // Never zero: no triangle shrinks to a point.
          values[number(c)] = std::abs(value) < 1e-4f * cell ? 1e-4f * cell : value;
        }
      }
    }
  }
  TriangleSoup soup;
  std::map<std::pair<int, int>, int32_t> crossings;
  const auto crossing = [&](const glm::ivec3& a, const glm::ivec3& b) {
    const auto [found, added] = crossings.try_emplace(std::minmax(number(a), number(b)), 0);
    if (added) {
      const float va = values[number(a)], vb = values[number(b)];
      found->second = soup.add_vertex(glm::mix(place(a), place(b), va / (va - vb)));
    }
    return found->second;
  };
  constexpr std::array<std::array<int, 3>, 6> kWays = {
      {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};
  for (int z = 0; z + 1 < count.z; ++z) {
    for (int y = 0; y + 1 < count.y; ++y) {
      for (int x = 0; x + 1 < count.x; ++x) {
        // The field is a distance: far from zero there is nothing to find.
        if (std::abs(values[number({x, y, z})]) > 2.0f * cell) continue;
        for (const auto& way : kWays) {
          // From the cell's lowest corner to its highest, one axis after the other.
          std::array<glm::ivec3, 4> corners{glm::ivec3(x, y, z)};
          for (int k = 0; k < 3; ++k) {
            corners[k + 1] = corners[k];
            ++corners[k + 1][way[k]];
          }
          std::vector<glm::ivec3> inside, outside;
          for (const glm::ivec3& c : corners) {
            (values[number(c)] < 0.0f ? inside : outside).push_back(c);
          }
          if (inside.empty() || outside.empty()) continue;
          std::vector<int32_t> collar;
          if (inside.size() == 2) {
            collar = {crossing(inside[0], outside[0]), crossing(inside[0], outside[1]),
                      crossing(inside[1], outside[1]), crossing(inside[1], outside[0])};
          } else {
            const bool one = inside.size() == 1;
            for (const glm::ivec3& c : one ? outside : inside) {
              collar.push_back(crossing(one ? inside[0] : outside[0], c));
            }
          }
          for (size_t k = 1; k + 1 < collar.size(); ++k)
            soup.add_triangle(collar[0], collar[k], collar[k + 1]);
        }
      }
    }
  }
  return soup;
}

/// Thinner limbs fall between the vertices of the grids below.
constexpr float kThinnestMarched = 0.045f;

/// Distance from a limb's surface, negative inside.
inline float outside_limb(const GrownLimb& limb, const glm::vec3& p) {
  const glm::vec3 along = limb.tip - limb.root;
  const float share =
      std::clamp(glm::dot(p - limb.root, along) / glm::dot(along, along), 0.0f, 1.0f);
  return glm::distance(p, limb.at(share)) - std::max(limb.radius_at(share), kThinnestMarched);
}

/// Distance from the surface around all limbs; the trunk stands on the ground, flat.
inline float outside_tree(const std::vector<GrownLimb>& limbs, const glm::vec3& p) {
  float least = std::numeric_limits<float>::infinity();
  for (const GrownLimb& limb : limbs) least = std::min(least, outside_limb(limb, p));
  return std::max(least, -p.z);
}

/// Every limb is found, on its parent, not farther from its true root than `tolerance` of the
/// parent's radius there, and ends at its tip.
inline void expect_limbs(const std::vector<GrownLimb>& limbs, const Skeleton& skeleton,
                         float tolerance) {
  ASSERT_EQ(skeleton.branches.size(), limbs.size());
  // By their tips, which no two limbs share.
  std::vector<int32_t> branch_of(limbs.size(), -1);
  for (size_t i = 0; i < limbs.size(); ++i) {
    float best = std::numeric_limits<float>::infinity();
    for (size_t b = 0; b < skeleton.branches.size(); ++b) {
      const float distance = glm::distance(skeleton.branches[b].points.back(), limbs[i].tip);
      if (distance >= best) continue;
      best = distance;
      branch_of[i] = static_cast<int32_t>(b);
    }
    // A marched limb ends in a ball.
    EXPECT_LT(best, 0.05f + limbs[i].radius_at(1.0f)) << "limb " << i;
  }
  for (size_t i = 0; i < limbs.size(); ++i) {
    const Branch& branch = skeleton.branches[branch_of[i]];
    const int32_t parent = limbs[i].parent;
    EXPECT_EQ(branch.parent, parent < 0 ? -1 : branch_of[parent]) << "limb " << i;
    if (parent < 0) continue;
    const float share = glm::distance(limbs[parent].root, limbs[i].root) /
                        glm::distance(limbs[parent].root, limbs[parent].tip);
    EXPECT_LT(glm::distance(branch.attach_point, limbs[i].root),
              tolerance * limbs[parent].radius_at(share))
        << "limb " << i;
  }
}

}  // namespace snowbough::tree
