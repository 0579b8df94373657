#include "snow/surface/flip_edges.h"

#include <algorithm>
#include <glm/geometric.hpp>

#include "base/parallel_for.h"
#include "snow/surface/vectors.h"

namespace snowbough::snow {
namespace {

constexpr int kRounds = 4;
/// An edge is flipped only if the new diagonal is shorter than this fraction of the old one.
constexpr float kShorter = 0.93f;
/// Least doubled area of a flipped triangle, as a fraction of the doubled area of both triangles.
constexpr float kMinArea = 0.05f;
/// Cosine of the greatest angle between receiver faces that count as coplanar: 5 degrees.
constexpr float kFlat = 0.996f;
/// A quad is a sliver if its short sides are at most the first fraction of its diagonal and its
/// long sides at least the second.
constexpr float kSliver = 0.4f;
constexpr float kLongSide = 0.85f;

class Flipper {
 public:
  Flipper(SurfaceMesh& mesh, const std::vector<glm::vec3>& shown) : mesh_(mesh), shown_(shown) {}

  /// Flips the edge that starts at corner `a` and, in the other triangle, at corner `b`. Returns
  /// true if the flip was made.
  bool flip(const TriangleCorner& a, const TriangleCorner& b) {
    const size_t s = static_cast<size_t>(a.triangle), t = static_cast<size_t>(b.triangle);
    if (!are_one_face(mesh_, a, b)) return false;
    const int a0 = a.k, a1 = (a.k + 1) % 3, a2 = (a.k + 2) % 3;
    const int b0 = b.k, b1 = (b.k + 1) % 3, b2 = (b.k + 2) % 3;
    const int32_t from = mesh_.triangle[s][a0], to = mesh_.triangle[s][a1];
    const int32_t left = mesh_.triangle[s][a2], right = mesh_.triangle[t][b2];
    if (left == right || mesh_.triangle[t][b0] != to || mesh_.triangle[t][b1] != from) return false;
    const float now = glm::distance(shown_[from], shown_[to]);
    if (glm::distance(shown_[left], shown_[right]) >= kShorter * now) return false;
    const glm::vec3 normal = triangle_cross(mesh_, s) + triangle_cross(mesh_, t);
    const float area = glm::dot(normal, normal);
    const auto part = [&](int32_t p, int32_t q, int32_t r) {
      const glm::vec3 cross =
          glm::cross(mesh_.position[q] - mesh_.position[p], mesh_.position[r] - mesh_.position[p]);
      return glm::dot(cross, normal);
    };
    if (part(from, right, left) < kMinArea * area || part(to, left, right) < kMinArea * area) {
      return false;
    }
    const glm::vec2 uv_left = mesh_.uv[s][a2], uv_right = mesh_.uv[t][b2];
    const glm::vec3 n_left = mesh_.normal[s][a2], n_right = mesh_.normal[t][b2];
    const glm::vec2 uv_from = mesh_.uv[s][a0], uv_to = mesh_.uv[s][a1];
    const glm::vec3 n_from = mesh_.normal[s][a0], n_to = mesh_.normal[s][a1];
    mesh_.triangle[s] = {from, right, left};
    mesh_.uv[s] = {uv_from, uv_right, uv_left};
    mesh_.normal[s] = {n_from, n_right, n_left};
    mesh_.triangle[t] = {to, left, right};
    mesh_.uv[t] = {uv_to, uv_left, uv_right};
    mesh_.normal[t] = {n_to, n_left, n_right};
    return true;
  }

 private:
  SurfaceMesh& mesh_;
  const std::vector<glm::vec3>& shown_;
};

}  // namespace

bool are_one_face(const SurfaceMesh& mesh, const TriangleCorner& a, const TriangleCorner& b) {
  const auto s = static_cast<size_t>(a.triangle), t = static_cast<size_t>(b.triangle);
  if (mesh.base[s] == mesh.base[t]) return true;
  const int a1 = (a.k + 1) % 3, b1 = (b.k + 1) % 3;
  // Texture coordinates and shading must be continuous across the edge.
  if (mesh.uv[s][a.k] != mesh.uv[t][b1] || mesh.uv[s][a1] != mesh.uv[t][b.k]) return false;
  const auto same = [](const glm::vec3& n, const glm::vec3& m) { return glm::dot(n, m) > kFlat; };
  if (!same(mesh.normal[s][a.k], mesh.normal[t][b1])) return false;
  if (!same(mesh.normal[s][a1], mesh.normal[t][b.k])) return false;
  return same(unit(triangle_cross(mesh, s)), unit(triangle_cross(mesh, t)));
}

std::vector<EdgeCorners> edge_corners(const SurfaceEdges& edges) {
  std::vector<EdgeCorners> corners(edges.ends.size());
  for (size_t t = 0; t < edges.of_triangle.size(); ++t) {
    for (int32_t k = 0; k < 3; ++k) {
      EdgeCorners& at = corners[edges.of_triangle[t][k]];
      if (at.count < 2) at.corner[at.count] = {static_cast<int32_t>(t), k};
      ++at.count;
    }
  }
  return corners;
}

std::vector<uint8_t> sliver_diagonals(const SurfaceMesh& mesh, const SurfaceEdges& edges) {
  std::vector<uint8_t> spared(edges.ends.size(), 0);
  const std::vector<EdgeCorners> corners = edge_corners(edges);
  base::for_each_item(spared.size(), 1024, [&](size_t e) {
    if (corners[e].count != 2) return;
    for (const TriangleCorner& corner : corners[e].corner) {
      const auto& [a, b, c] = mesh.triangle[corner.triangle];
      const std::array<float, 3> side{glm::distance(mesh.position[a], mesh.position[b]),
                                      glm::distance(mesh.position[b], mesh.position[c]),
                                      glm::distance(mesh.position[c], mesh.position[a])};
      const float own = side[corner.k];
      const auto [least, most] = std::minmax(side[(corner.k + 1) % 3], side[(corner.k + 2) % 3]);
      if (most > own || most < kLongSide * own || least > kSliver * own) return;
    }
    spared[e] = are_one_face(mesh, corners[e].corner[0], corners[e].corner[1]) ? 1 : 0;
  });
  return spared;
}

void flip_edges(SurfaceMesh& mesh, const std::vector<glm::vec3>& shown) {
  Flipper flipper(mesh, shown);
  for (int round = 0; round < kRounds; ++round) {
    const SurfaceEdges edges = surface_edges(mesh.triangle);
    const std::vector<EdgeCorners> corners = edge_corners(edges);
    // Each triangle is flipped at most once per round, because a flip changes its edges.
    std::vector<uint8_t> turned(mesh.triangle.size(), 0);
    bool any = false;
    for (size_t e = 0; e < edges.ends.size(); ++e) {
      if (corners[e].count != 2) continue;
      const auto& [a, b] = corners[e].corner;
      if (turned[a.triangle] != 0 || turned[b.triangle] != 0) continue;
      if (flipper.flip(a, b)) {
        turned[a.triangle] = turned[b.triangle] = 1;
        any = true;
      }
    }
    if (!any) return;
  }
}

}  // namespace snowbough::snow
