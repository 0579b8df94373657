#include "snow/surface/folds.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace snowbough::snow {
namespace {

/// Upward component of the normals of the steepest faces that count.
constexpr float kSteepest = 0.1f;
/// The underside of a front leans outwards by at least this cosine.
constexpr float kLeansOut = 0.2f;
/// Upward component of the normals of steeper faces, for the way over them.
constexpr float kLeastUp = 0.7f;
/// Level part of an upright offset, as a fraction of its height.
constexpr float kUpright = 0.003f;
constexpr int kSweeps = 24;

/// Whether the normals of a triangle's corners lean together.
bool is_hollow(const SurfacePoints& points, size_t triangle) {
  const auto& corner = points.mesh.triangle[triangle];
  for (int k = 0; k < 3; ++k) {
    const int32_t from = corner[k], to = corner[(k + 1) % 3];
    if (glm::dot(points.normal[to] - points.normal[from],
                 points.mesh.position[to] - points.mesh.position[from]) < 0.0f) {
      return true;
    }
  }
  return false;
}

/// Whether an offset is the column of snow over its point, as in a bowl: it does not become lower.
bool is_upright(const glm::vec3& offset) {
  return std::hypot(offset.x, offset.y) < kUpright * offset.z;
}

/// Whether a triangle's drawn snow is upside down, and neither hangs over the edge of a border nor,
/// as a front, over a rim.
/// @param is_beside whether one of its points belongs to a fold.
bool is_folded(const SurfacePoints& points, size_t triangle, const std::vector<glm::vec3>& drawn,
               const std::vector<glm::vec3>& out, bool is_beside) {
  const auto& [a, b, c] = points.mesh.triangle[triangle];
  const glm::vec3 now = glm::cross(drawn[b] - drawn[a], drawn[c] - drawn[a]);
  const glm::vec3 bare = triangle_cross(points.mesh, triangle);
  if (now.z >= 0.0f || bare.z < kSteepest * glm::length(bare)) return false;
  const glm::vec3 over = out[a] + out[b] + out[c];
  if (over == glm::vec3(0.0f)) return is_beside || is_hollow(points, triangle);
  return is_beside && glm::dot(over, now) <= kLeansOut * glm::length(over) * glm::length(now);
}

}  // namespace

bool add_folds(Folds& folds, const SurfacePoints& points, const std::vector<glm::vec3>& drawn,
               const std::vector<float>& shown, const std::vector<glm::vec3>& out) {
  const SurfaceMesh& mesh = points.mesh;
  std::vector<uint8_t> inside(mesh.position.size(), 0);
  for (const int32_t p : folds.point) inside[p] = 1;
  std::vector<uint8_t> folded(inside.size(), 0);
  bool adds = false;
  for (size_t t = 0; t < mesh.triangle.size(); ++t) {
    const auto& [a, b, c] = mesh.triangle[t];
    if (std::max({shown[a], shown[b], shown[c]}) <= 0.0f) continue;
    if (!is_folded(points, t, drawn, out, (inside[a] | inside[b] | inside[c]) != 0)) continue;
    adds = adds || (inside[a] & inside[b] & inside[c]) == 0;
    folded[a] = folded[b] = folded[c] = 1;
  }
  if (!adds) return false;
  for (const auto& [a, b, c] : mesh.triangle) {
    if ((folded[a] | folded[b] | folded[c]) != 0) inside[a] = inside[b] = inside[c] = 1;
  }
  // Each point beside another follows it in one triangle, but for one at the mesh's border.
  std::vector<std::vector<int32_t>> beside(inside.size());
  for (const auto& triangle : mesh.triangle) {
    for (int k = 0; k < 3; ++k) {
      if (inside[triangle[k]] != 0) beside[triangle[k]].push_back(triangle[(k + 1) % 3]);
    }
  }
  folds = {};
  for (size_t p = 0; p < inside.size(); ++p) {
    if (inside[p] == 0) continue;
    folds.point.push_back(static_cast<int32_t>(p));
    folds.beside.insert(folds.beside.end(), beside[p].begin(), beside[p].end());
    folds.beside_begin.push_back(static_cast<int32_t>(folds.beside.size()));
  }
  return true;
}

void even_out(const Folds& folds, const std::vector<glm::vec3>& normal,
              std::vector<glm::vec3>& offsets) {
  if (folds.point.empty()) return;
  // By how much a point's face rises along the level part of its offset.
  const auto rise = [&](int32_t p, const glm::vec3& over) {
    return -(normal[p].x * over.x + normal[p].y * over.y) / std::max(normal[p].z, kLeastUp);
  };
  // The level part of an offset, and the height of the column of snow over the face there.
  std::vector<glm::vec3> column(offsets.size());
  for (const int32_t p : folds.beside) {
    column[p] = {offsets[p].x, offsets[p].y, offsets[p].z - rise(p, offsets[p])};
  }
  const size_t count = folds.point.size();
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (size_t n = 0; n < count; ++n) {
      const size_t i = sweep % 2 == 0 ? n : count - 1 - n;
      const int32_t begin = folds.beside_begin[i], end = folds.beside_begin[i + 1];
      glm::vec3 sum(0.0f);
      for (int32_t k = begin; k < end; ++k) sum += column[folds.beside[k]];
      column[folds.point[i]] = sum / static_cast<float>(end - begin);
    }
  }
  for (const int32_t p : folds.point) {
    const float least = is_upright(offsets[p]) ? offsets[p].z : 0.0f;
    const float height = column[p].z + rise(p, column[p]);
    offsets[p] = {column[p].x, column[p].y, std::max(height, least)};
  }
}

}  // namespace snowbough::snow
