#include "snow/surface/joints.h"

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>

#include "base/parallel_for.h"
#include "base/triangle_tree.h"
#include "base/union_find.h"
#include "shaders/lib/snow_surface.h"
#include "snow/surface/snow_surface.h"

namespace snowbough::snow {
namespace {

/// Part of the reach, from the joint on, that lies fully at it.
constexpr float kFully = 0.3f;
/// A point is within other snow if a ray along its normal leaves that within so many metres.
constexpr double kThickest = 0.5;
constexpr double kOffOwn = 1e-4;
/// Edges from a joint, at most, within the reach.
constexpr int kRounds = 8;

}  // namespace

std::vector<float> nearness_to_joints(const std::vector<glm::vec3>& points,
                                      const std::vector<glm::ivec3>& triangles, float reach) {
  const std::vector<glm::vec3> normals = point_normals(points, triangles);
  std::vector<std::array<int32_t, 3>> corners;
  for (const glm::ivec3& t : triangles) corners.push_back({t.x, t.y, t.z});
  const base::TriangleTree tree(points, corners, {0, static_cast<int32_t>(corners.size())});
  base::UnionFind joined(points.size());
  for (const auto& [a, b, c] : corners) joined.join(joined.join(a, b), c);
  const std::vector<int32_t> piece = std::move(joined).all();
  // Distance from a joint along the edges.
  std::vector<float> distance(points.size(), reach);
  base::for_each_item(points.size(), 256, [&](size_t p) {
    const glm::dvec3 normal = normals[p];
    const auto [t, way] = tree.first_along(0, glm::dvec3(points[p]), normal, kOffOwn, kThickest);
    if (t < 0 || piece[corners[t][0]] == piece[p]) return;
    const glm::vec3 cross = glm::cross(points[corners[t][1]] - points[corners[t][0]],
                                       points[corners[t][2]] - points[corners[t][0]]);
    if (glm::dot(cross, normals[p]) > 0.0f) distance[p] = 0.0f;
  });
  for (int round = 0; round < kRounds; ++round) {
    for (const auto& triangle : corners) {
      for (size_t k = 0; k < 3; ++k) {
        const int32_t a = triangle[k], b = triangle[(k + 1) % 3];
        const float length = glm::distance(points[a], points[b]);
        distance[a] = std::min(distance[a], distance[b] + length);
        distance[b] = std::min(distance[b], distance[a] + length);
      }
    }
  }
  for (float& one : distance) one = shared::eased(one, reach, kFully * reach);
  return distance;
}

}  // namespace snowbough::snow
