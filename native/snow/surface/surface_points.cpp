#include "snow/surface/surface_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "base/parallel_for.h"
#include "snow/surface/vectors.h"

namespace snowbough::snow {
namespace {

/// Half of Phong tessellation is exact on a sphere.
constexpr float kCurvature = 0.5f;
/// Distance over which creases are smoothed, as a fraction of the depth.
constexpr float kCrease = 0.3f;
/// Difference of the normals at the ends of an edge, along the edge, over which a crease is hollow.
constexpr float kHollow = 0.15f;
/// Smooth normals on a hollow face lean together by at most this over the depth of the snow.
constexpr float kLeansTogether = 0.1f;

/// How much of a triangle's smooth normals' lean stays: where they lean together, snow along them
/// would grow through that of the other side.
float kept_lean(const SurfaceMesh& mesh, size_t triangle, float depth) {
  float together = 0.0f;
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    const glm::vec3 apart =
        mesh.position[mesh.triangle[triangle][next]] - mesh.position[mesh.triangle[triangle][k]];
    const glm::vec3 bend = mesh.normal[triangle][next] - mesh.normal[triangle][k];
    const float squared = glm::dot(apart, apart);
    if (squared > 0.0f) together = std::max(together, -depth * glm::dot(bend, apart) / squared);
  }
  return std::min(1.0f, kLeansTogether / std::max(together, kLeansTogether));
}

}  // namespace

SurfacePoints carried_points(SurfaceMesh mesh, const SurfaceSource& source) {
  SurfacePoints points;
  points.mesh = std::move(mesh);
  const size_t count = points.count();
  const std::vector<int32_t>& triangles = source.topology.triangles;
  points.triangle.assign(count, -1);
  points.weight.assign(count, glm::vec2(0.0f));
  points.curvature.assign(count, glm::vec3(0.0f));
  // Choose the receiver triangle that contains the point: a triangle of the surface may span two of
  // them.
  std::vector<float> inside(count, 0.0f);
  for (size_t t = 0; t < points.mesh.triangle.size(); ++t) {
    const int32_t base = points.mesh.base[t];
    const int32_t* corner = &triangles[static_cast<size_t>(base) * 3];
    const glm::dvec3 a(source.positions[corner[0]]);
    const glm::dvec3 ab = glm::dvec3(source.positions[corner[1]]) - a;
    const glm::dvec3 ac = glm::dvec3(source.positions[corner[2]]) - a;
    const double bb = glm::dot(ab, ab), bc = glm::dot(ab, ac), cc = glm::dot(ac, ac);
    const double area = bb * cc - bc * bc;
    for (const int32_t p : points.mesh.triangle[t]) {
      if (points.triangle[p] == base) continue;
      const glm::dvec3 ap = glm::dvec3(points.mesh.position[p]) - a;
      const double pb = glm::dot(ap, ab), pc = glm::dot(ap, ac);
      glm::vec2 weight(0.0f);
      if (area > 0.0) weight = {(cc * pb - bc * pc) / area, (bb * pc - bc * pb) / area};
      // The tolerance keeps rounding from choosing between triangles that share the point.
      const float least = std::min({weight.x, weight.y, 1.0f - weight.x - weight.y, 0.0f});
      if (points.triangle[p] >= 0 && least <= inside[p] + 1e-4f) continue;
      points.triangle[p] = base;
      points.weight[p] = weight;
      inside[p] = least;
    }
  }
  if (source.shading.empty()) return points;
  // Half of Phong tessellation: T. Boubekeur, M. Alexa, Phong Tessellation, SIGGRAPH Asia 2008.
  // Corners with the same shading number share a normal.
  std::vector<glm::vec3> normal(
      static_cast<size_t>(
          std::max(*std::max_element(source.shading.begin(), source.shading.end()), 0)) +
          1,
      glm::vec3(0.0f));
  for (size_t c = 0; c < triangles.size(); c += 3) {
    const glm::vec3 cross =
        glm::cross(source.positions[triangles[c + 1]] - source.positions[triangles[c]],
                   source.positions[triangles[c + 2]] - source.positions[triangles[c]]);
    for (size_t k = 0; k < 3; ++k) {
      if (source.shading[c + k] >= 0) normal[source.shading[c + k]] += cross;
    }
  }
  for (glm::vec3& n : normal) n = unit(n);
  for (size_t p = 0; p < count; ++p) {
    const size_t c = static_cast<size_t>(points.triangle[p]) * 3;
    if (source.shading[c] < 0 || source.shading[c + 1] < 0 || source.shading[c + 2] < 0) continue;
    const glm::vec2 w = points.weight[p];
    const std::array<float, 3> weight{1.0f - w.x - w.y, w.x, w.y};
    glm::vec3 shift(0.0f);
    for (size_t k = 0; k < 3; ++k) {
      const glm::vec3& n = normal[source.shading[c + k]];
      shift -=
          weight[k] * glm::dot(points.mesh.position[p] - source.positions[triangles[c + k]], n) * n;
    }
    points.curvature[p] = kCurvature * shift;
  }
  return points;
}

void find_normals(SurfacePoints& points, const HeightSamples& samples, float depth) {
  const float reach = kCrease * depth;
  std::vector<glm::vec3>& normal = points.normal;
  normal.assign(points.count(), glm::vec3(0.0f));
  for (size_t t = 0; t < points.mesh.triangle.size(); ++t) {
    const glm::vec3 cross = triangle_cross(points.mesh, t);
    const float area = glm::length(cross);
    const float level = area > 0.0f ? std::clamp(cross.z / area, 0.0f, 1.0f) : 0.0f;
    const glm::vec3 flat = unit(cross);
    const float kept = kept_lean(points.mesh, t, depth);
    for (int k = 0; k < 3; ++k) {
      normal[points.mesh.triangle[t][k]] +=
          glm::mix(flat, points.mesh.normal[t][k], kept) * (area * (0.02f + level * level));
    }
  }
  for (glm::vec3& one : normal) one = unit(one);
  // Snow bends over creases between flat faces with a radius of about its depth.
  // Over hollow creases it does not: normals that lean together would push it into itself.
  constexpr int kRounds = 12;
  const std::vector<glm::vec3> unsmoothed = normal;
  std::vector<glm::vec3> before;
  for (int round = 0; round < kRounds; ++round) {
    before = normal;
    base::for_each_item(points.count(), 1024, [&](size_t p) {
      glm::vec3 sum = before[p];
      for (int32_t i = samples.neighbour_begin[p]; i < samples.neighbour_begin[p + 1]; ++i) {
        const glm::vec3 apart =
            points.mesh.position[p] - points.mesh.position[samples.neighbour[i]];
        const glm::vec3 bend = unsmoothed[p] - unsmoothed[samples.neighbour[i]];
        if (glm::dot(bend, apart) < -kHollow * glm::length(apart)) continue;
        sum += before[samples.neighbour[i]] *
               (samples.neighbour_weight[i] > 0.0f
                    ? 0.5f * std::exp(-glm::dot(apart, apart) / (reach * reach))
                    : 0.0f);
      }
      normal[p] = unit(sum);
    });
  }
}

}  // namespace snowbough::snow
