#include "snow/surface/surface_faces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "snow/surface/vectors.h"

namespace snowbough::snow {

SurfaceFaces surface_faces(const SurfaceMesh& mesh, const Cushions& cushions) {
  // Merge two nearly coplanar triangles of one chart into a quad, which takes a third less memory
  // in Blender.
  const SurfaceEdges edges = surface_edges(mesh.triangle);
  const std::vector<glm::vec3> normals = triangle_normals(mesh);
  struct Side {
    int32_t triangle = -1;
    int32_t k = 0;
  };
  std::vector<std::array<Side, 2>> sides(edges.ends.size());
  std::vector<int32_t> count(edges.ends.size(), 0);
  for (size_t t = 0; t < mesh.triangle.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int32_t e = edges.of_triangle[t][k];
      if (count[e] < 2) sides[e][count[e]] = {static_cast<int32_t>(t), k};
      ++count[e];
    }
  }
  struct Pair {
    float cost;
    int32_t edge;
  };
  std::vector<Pair> pairs;
  for (size_t e = 0; e < edges.ends.size(); ++e) {
    if (count[e] != 2) continue;
    const auto [a, b] = sides[e];
    if (glm::dot(normals[a.triangle], normals[b.triangle]) < 0.97f) continue;
    const auto& uv = mesh.uv;
    if (uv[a.triangle][a.k] != uv[b.triangle][(b.k + 1) % 3] ||
        uv[a.triangle][(a.k + 1) % 3] != uv[b.triangle][b.k]) {
      continue;
    }
    // Corners of the quad, and the deviation of its worst angle from a right angle.
    const std::array<int32_t, 4> corner{
        mesh.triangle[a.triangle][(a.k + 2) % 3], mesh.triangle[a.triangle][a.k],
        mesh.triangle[b.triangle][(b.k + 2) % 3], mesh.triangle[b.triangle][b.k]};
    float worst = 0.0f;
    for (size_t k = 0; k < 4; ++k) {
      const glm::vec3 in = unit(mesh.position[corner[(k + 3) % 4]] - mesh.position[corner[k]]);
      const glm::vec3 out = unit(mesh.position[corner[(k + 1) % 4]] - mesh.position[corner[k]]);
      const float turn = glm::dot(glm::cross(out, in), normals[a.triangle]);
      worst = std::max(worst, turn > 0.1f ? std::abs(glm::dot(in, out)) : 9.0f);
    }
    if (worst < 0.9f) pairs.push_back({worst, static_cast<int32_t>(e)});
  }
  std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) {
    return a.cost != b.cost ? a.cost < b.cost : a.edge < b.edge;
  });
  std::vector<int32_t> partner(mesh.triangle.size(), -1);
  for (const Pair& pair : pairs) {
    const auto [a, b] = sides[pair.edge];
    if (partner[a.triangle] >= 0 || partner[b.triangle] >= 0) continue;
    partner[a.triangle] = pair.edge;
    partner[b.triangle] = pair.edge;
  }
  SurfaceFaces faces;
  const auto add = [&](int32_t t, int k) {
    faces.corner.push_back(mesh.triangle[t][k % 3]);
    faces.uv.push_back(mesh.uv[t][k % 3]);
  };
  for (size_t t = 0; t < mesh.triangle.size(); ++t) {
    const auto own = static_cast<int32_t>(t);
    if (partner[t] < 0) {
      for (int k = 0; k < 3; ++k) add(own, k);
    } else {
      const auto [a, b] = sides[partner[t]];
      if (a.triangle != own) continue;
      add(a.triangle, a.k + 2);
      add(a.triangle, a.k);
      add(b.triangle, b.k + 2);
      add(b.triangle, b.k);
    }
    faces.begin.push_back(static_cast<int32_t>(faces.corner.size()));
  }
  // A cushion point has the texture coordinates of its anchor.
  std::vector<glm::vec2> uv(mesh.position.size(), glm::vec2(0.0f));
  for (size_t t = 0; t < mesh.triangle.size(); ++t) {
    for (int k = 0; k < 3; ++k) uv[mesh.triangle[t][k]] = mesh.uv[t][k];
  }
  for (const auto& quad : cushions.quads) {
    for (const int32_t c : quad) {
      faces.corner.push_back(static_cast<int32_t>(mesh.position.size()) + c);
      faces.uv.push_back(uv[cushions.anchor[c]]);
    }
    faces.begin.push_back(static_cast<int32_t>(faces.corner.size()));
  }
  return faces;
}

}  // namespace snowbough::snow
