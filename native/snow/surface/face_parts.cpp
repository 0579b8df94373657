#include "snow/surface/face_parts.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "base/group_by_key.h"
#include "base/union_find.h"
#include "snow/surface/vectors.h"

namespace snowbough::snow {
namespace {

constexpr float kTurn = 2.0f * std::numbers::pi_v<float>;
/// Faces within this angle coincide; faces continue each other up to this turn, in radians.
constexpr float kSame = 1e-3f;
constexpr float kStraight = kTurn / 8.0f;

/// A face at an edge, and its angle around it.
struct Blade {
  float angle;
  int32_t face;
};

float apart(float a, float b) {
  const float turn = std::abs(a - b);
  return std::min(turn, kTurn - turn);
}

/// The faces around an edge, by angle from the first one.
std::vector<Blade> blades_around(const SurfaceMesh& mesh, const std::array<int32_t, 2>& ends,
                                 const int32_t* face, size_t count) {
  const glm::vec3& from = mesh.position[ends[0]];
  const glm::vec3 axis = unit(mesh.position[ends[1]] - from);
  glm::vec3 x(0.0f);
  std::vector<Blade> blades;
  for (size_t i = 0; i < count; ++i) {
    const auto& corners = mesh.triangle[face[i]];
    glm::vec3 off(0.0f);
    for (const int32_t p : corners) {
      if (p != ends[0] && p != ends[1]) off = mesh.position[p] - from;
    }
    off -= axis * glm::dot(off, axis);
    if (i == 0) x = unit(off);
    const float angle = std::atan2(glm::dot(off, glm::cross(axis, x)), glm::dot(off, x));
    blades.push_back({angle < 0.0f ? angle + kTurn : angle, face[i]});
  }
  std::sort(blades.begin(), blades.end(), [](const Blade& a, const Blade& b) {
    return a.angle != b.angle ? a.angle < b.angle : a.face < b.face;
  });
  return blades;
}

/// Joins the faces around an edge that coincide, and then the straightest pairs.
void join_opposite(const std::vector<Blade>& blades, base::UnionFind& joined) {
  std::vector<Blade> distinct;
  for (const Blade& blade : blades) {
    if (!distinct.empty() && blade.angle - distinct.back().angle < kSame) {
      joined.join(blade.face, distinct.back().face);
    } else {
      distinct.push_back(blade);
    }
  }
  if (distinct.size() > 1 && apart(distinct.front().angle, distinct.back().angle) < kSame) {
    joined.join(distinct.front().face, distinct.back().face);
    distinct.pop_back();
  }
  struct Pair {
    float turn;
    size_t a, b;
  };
  std::vector<Pair> pairs;
  for (size_t a = 0; a < distinct.size(); ++a) {
    const float opposite = std::fmod(distinct[a].angle + 0.5f * kTurn, kTurn);
    const auto next = std::lower_bound(distinct.begin(), distinct.end(), opposite,
                                       [](const Blade& b, float at) { return b.angle < at; });
    const auto after = static_cast<size_t>(next - distinct.begin());
    for (const size_t b :
         {after % distinct.size(), (after + distinct.size() - 1) % distinct.size()}) {
      const float turn = apart(distinct[b].angle, opposite);
      if (b != a && turn <= kStraight) pairs.push_back({turn, std::min(a, b), std::max(a, b)});
    }
  }
  std::sort(pairs.begin(), pairs.end(), [](const Pair& p, const Pair& q) {
    return p.turn != q.turn ? p.turn < q.turn : p.a != q.a ? p.a < q.a : p.b < q.b;
  });
  std::vector<uint8_t> has(distinct.size(), 0);
  for (const Pair& pair : pairs) {
    if (has[pair.a] != 0 || has[pair.b] != 0) continue;
    has[pair.a] = has[pair.b] = 1;
    joined.join(distinct[pair.a].face, distinct[pair.b].face);
  }
}

}  // namespace

std::vector<int32_t> face_parts(const SurfaceMesh& mesh) {
  const SurfaceEdges edges = surface_edges(mesh.triangle);
  const auto for_faces = [&](const auto& visit) {
    for (size_t t = 0; t < mesh.triangle.size(); ++t) {
      for (const int32_t e : edges.of_triangle[t]) visit(e, static_cast<int32_t>(t));
    }
  };
  std::vector<size_t> begin;
  std::vector<int32_t> face;
  base::group_by_key(edges.ends.size(), for_faces, begin, face);
  base::UnionFind joined(mesh.triangle.size());
  for (size_t e = 0; e < edges.ends.size(); ++e) {
    const int32_t* first = &face[begin[e]];
    const size_t count = begin[e + 1] - begin[e];
    if (count == 2) {
      joined.join(first[0], first[1]);
    } else if (count > 2) {
      join_opposite(blades_around(mesh, edges.ends[e], first, count), joined);
    }
  }
  return std::move(joined).all();
}

}  // namespace snowbough::snow
