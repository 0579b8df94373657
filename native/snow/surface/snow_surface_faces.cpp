#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "snow/surface/snow_surface.h"
#include "snow/surface/vectors.h"

// The faces of SnowSurface.

namespace snowbough::snow {

void SnowSurface::drop_bare_sheets(const std::vector<float>& highest, float depth) {
  SurfaceFrame frame;
  frame.height = highest.data();
  frame.open_depth = depth;
  std::vector<uint8_t> shows(lying_points(), 0);
  const std::vector<float> shown = shown_heights(frame);
  // Snow on the back has negative heights and must count as well.
  std::vector<float> below = highest;
  for (float& height : below) height = -height;
  frame.height = below.data();
  const std::vector<float> shown_below = shown_heights(frame);
  for (size_t p = 0; p < shows.size(); ++p) {
    shows[p] = is_sheet_[p] == 0 || shown[p] > 0.0f || shown_below[p] > 0.0f ? 1 : 0;
  }
  SurfaceMesh kept = mesh_;
  kept.triangle.clear();
  kept.uv.clear();
  kept.normal.clear();
  kept.base.clear();
  for (size_t t = 0; t < mesh_.triangle.size(); ++t) {
    const auto& [a, b, c] = mesh_.triangle[t];
    if (shows[a] == 0 && shows[b] == 0 && shows[c] == 0) continue;
    kept.triangle.push_back(mesh_.triangle[t]);
    kept.uv.push_back(mesh_.uv[t]);
    kept.normal.push_back(mesh_.normal[t]);
    kept.base.push_back(mesh_.base[t]);
  }
  mesh_ = std::move(kept);
}

void SnowSurface::make_faces() {
  // Merge two nearly coplanar triangles of one chart into a quad, which takes a third less memory
  // in Blender.
  const SurfaceEdges edges = surface_edges(mesh_.triangle);
  const std::vector<glm::vec3> normals = triangle_normals(mesh_);
  struct Side {
    int32_t triangle = -1;
    int32_t k = 0;
  };
  std::vector<std::array<Side, 2>> sides(edges.ends.size());
  std::vector<int32_t> count(edges.ends.size(), 0);
  for (size_t t = 0; t < mesh_.triangle.size(); ++t) {
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
    const auto& uv = mesh_.uv;
    if (uv[a.triangle][a.k] != uv[b.triangle][(b.k + 1) % 3] ||
        uv[a.triangle][(a.k + 1) % 3] != uv[b.triangle][b.k]) {
      continue;
    }
    // Corners of the quad, and the deviation of its worst angle from a right angle.
    const std::array<int32_t, 4> corner{
        mesh_.triangle[a.triangle][(a.k + 2) % 3], mesh_.triangle[a.triangle][a.k],
        mesh_.triangle[b.triangle][(b.k + 2) % 3], mesh_.triangle[b.triangle][b.k]};
    float worst = 0.0f;
    for (size_t k = 0; k < 4; ++k) {
      const glm::vec3 in = unit(mesh_.position[corner[(k + 3) % 4]] - mesh_.position[corner[k]]);
      const glm::vec3 out = unit(mesh_.position[corner[(k + 1) % 4]] - mesh_.position[corner[k]]);
      const float turn = glm::dot(glm::cross(out, in), normals[a.triangle]);
      worst = std::max(worst, turn > 0.1f ? std::abs(glm::dot(in, out)) : 9.0f);
    }
    if (worst < 0.9f) pairs.push_back({worst, static_cast<int32_t>(e)});
  }
  std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) {
    return a.cost != b.cost ? a.cost < b.cost : a.edge < b.edge;
  });
  std::vector<int32_t> partner(mesh_.triangle.size(), -1);
  for (const Pair& pair : pairs) {
    const auto [a, b] = sides[pair.edge];
    if (partner[a.triangle] >= 0 || partner[b.triangle] >= 0) continue;
    partner[a.triangle] = pair.edge;
    partner[b.triangle] = pair.edge;
  }
  faces_.begin.push_back(0);
  const auto add = [&](int32_t t, int k) {
    faces_.corner.push_back(mesh_.triangle[t][k % 3]);
    faces_.uv.push_back(mesh_.uv[t][k % 3]);
  };
  for (size_t t = 0; t < mesh_.triangle.size(); ++t) {
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
    faces_.begin.push_back(static_cast<int32_t>(faces_.corner.size()));
  }
  // A cushion point has the texture coordinates of its anchor.
  std::vector<glm::vec2> uv(lying_points(), glm::vec2(0.0f));
  for (size_t t = 0; t < mesh_.triangle.size(); ++t) {
    for (int k = 0; k < 3; ++k) uv[mesh_.triangle[t][k]] = mesh_.uv[t][k];
  }
  for (const auto& quad : cushions_.quads) {
    for (const int32_t c : quad) {
      faces_.corner.push_back(static_cast<int32_t>(lying_points()) + c);
      faces_.uv.push_back(uv[cushions_.anchor[c]]);
    }
    faces_.begin.push_back(static_cast<int32_t>(faces_.corner.size()));
  }
}

}  // namespace snowbough::snow
