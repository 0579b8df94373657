#include "tree/crossings/faces.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <vector>

#include "tree/crossings/triangles.h"

namespace snowbough::tree {
namespace {

using base::bits;
using base::Float4;
using base::four;
using base::Int4;
using base::largest;
using base::rotated;
using base::smallest;

/// Distance from a plane, relative to the coordinates, beyond which rounding cannot change the
/// side; for floats and for doubles.
constexpr float kClear = 3e-6f;
constexpr double kClearDouble = 1e-12;
/// Faces whose box sides sum to less or more use the exact test, before floats overflow or lose
/// digits.
constexpr float kSmallest = 1e-6f;
constexpr float kLargest = 1e6f;
/// Number of turns of a separating plane before the exact test.
constexpr int kTurns = 8;
/// Corners of a face's two triangles.
constexpr int kTriangles[2][3] = {{0, 1, 2}, {0, 2, 3}};
/// As kClear, for the area spanned by two edges, relative to the squared size of the face.
constexpr float kClearArea = 1e-5f;
/// Maximum number of faces around a spread vertex. Angles under 180 degrees between successive
/// edges of a closed fan are a multiple of 360 degrees in all: with four faces or less, one turn.
constexpr size_t kMaxAround = 4;
constexpr float kUnbounded = std::numeric_limits<float>::infinity();

using Corners = std::array<glm::dvec3, 4>;

glm::vec3 corner(const CrossingFace& face, int k) {
  return {face.x[k], face.y[k], face.z[k]};
}

Corners points(const CrossingFace& face) {
  return {corner(face, 0), corner(face, 1), corner(face, 2), corner(face, 3)};
}

/// A face's corners relative to a point; corners shared with another face are replaced by one that
/// is not shared.
struct Seen {
  Float4 x, y, z;

  Seen(const CrossingFace& face, const Int4& shared, const glm::vec3& from) {
    const int free = std::countr_one(bits(shared)) & 3;
    x = (shared ? four(face.x[free]) : face.x) - from.x;
    y = (shared ? four(face.y[free]) : face.y) - from.y;
    z = (shared ? four(face.z[free]) : face.z) - from.z;
  }
  /// Heights above the plane through that point.
  Float4 heights(const glm::vec3& normal) const {
    return normal.x * x + normal.y * y + normal.z * z;
  }
  /// The first corner with that height.
  glm::vec3 at(const Float4& heights, float height) const {
    const int k = std::countr_zero(bits(heights == height) | 8u);
    return {x[k], y[k], z[k]};
  }
};

float length_of(const glm::vec3& v) {
  return std::sqrt(glm::dot(v, v));
}

/// Whether a plane through the shared corners separates all other corners of two faces with a
/// margin. Turns the plane until it separates the two worst corners.
///
/// Source: K. Chung and W. Wang, "Quick Collision Detection of Polytopes in Virtual Environments",
/// ACM VRST 1996.
/// @param margin  required distance from the plane.
/// @param touching  the plane passes through the origin; else it is free.
bool turn_until_separated(const Seen& f, const Seen& g, glm::vec3 normal, float margin,
                          bool touching, int turns) {
  for (int turn = 0;; ++turn) {
    const Float4 of_f = f.heights(normal), of_g = g.heights(normal);
    const float highest_f = largest(of_f), lowest_g = smallest(of_g);
    const bool below = highest_f<-margin, above = lowest_g> margin;
    if (touching ? below && above : highest_f + margin < lowest_g) {
      return true;
    }
    if (turn == turns) {
      return false;
    }
    const glm::vec3 p = f.at(of_f, highest_f), q = g.at(of_g, lowest_g);
    const glm::vec3 away = !touching ? q - p
                           : above   ? -p
                           : below   ? q
                                     : q / length_of(q) - p / length_of(p);
    const float squared = glm::dot(away, away);
    // Coincident corners, or NaN.
    if (!(squared > std::numeric_limits<float>::min())) {
      return false;
    }
    normal -= away * (2.0f * glm::dot(normal, away) / squared);
  }
}

/// Per corner of a quad the vector area spanned by the edges there: a Float4 for each axis.
struct CornerAreas {
  Float4 x, y, z;
};

CornerAreas corner_areas(const CrossingFace& face) {
  const Float4 ax = rotated(face.x) - face.x, bx = rotated(rotated(rotated(ax)));
  const Float4 ay = rotated(face.y) - face.y, by = rotated(rotated(rotated(ay)));
  const Float4 az = rotated(face.z) - face.z, bz = rotated(rotated(rotated(az)));
  return {by * az - bz * ay, bz * ax - bx * az, bx * ay - by * ax};
}

/// Whether the faces with these corners (4 face + corner) at one vertex form a closed fan of quads
/// that are convex, seen along their mean normal: then each is within the angle between its edges
/// at the vertex, and these angles do not overlap.
bool is_spread(std::span<const CrossingFace> faces, std::span<const CornerAreas> areas,
               std::span<const int32_t> corners) {
  std::array<int32_t, kMaxAround> next{}, before{};
  glm::vec3 normal(0.0f);
  for (size_t i = 0; i < corners.size(); ++i) {
    const CrossingFace& face = faces[corners[i] / 4];
    const int k = corners[i] % 4;
    next[i] = face.corners[(k + 1) & 3];
    before[i] = face.corners[(k + 3) & 3];
    const CornerAreas& own = areas[corners[i] / 4];
    normal += glm::vec3(own.x[k], own.y[k], own.z[k]);
  }
  const float components = std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z);
  for (size_t i = 0; i < corners.size(); ++i) {
    const float size = faces[corners[i] / 4].size;
    const CornerAreas& own = areas[corners[i] / 4];
    const Float4 seen = normal.x * own.x + normal.y * own.y + normal.z * own.z;
    // Not for NaN either.
    if (!(smallest(seen) > kClearArea * size * size * components)) return false;
  }
  const auto count = static_cast<std::ptrdiff_t>(corners.size());
  return std::is_permutation(next.begin(), next.begin() + count, before.begin());
}

/// Whether a plane through the shared corners proves that two faces have nothing else in common;
/// false leaves it to the exact test.
bool separated(const CrossingFace& f, const CrossingFace& g) {
  if (!(std::min(f.size, g.size) > kSmallest && std::max(f.size, g.size) < kLargest)) {
    return false;
  }
  // Compares corner k of f with corner k + turn of g, and back.
  Int4 other = g.corners;
  Int4 same = f.corners == other;
  Int4 shared_f = same, shared_g = same;
  other = rotated(other);
  same = f.corners == other;
  shared_f |= same;
  shared_g |= rotated(rotated(rotated(same)));
  other = rotated(other);
  same = f.corners == other;
  shared_f |= same;
  shared_g |= rotated(rotated(same));
  other = rotated(other);
  same = f.corners == other;
  shared_f |= same;
  shared_g |= rotated(same);

  const uint32_t set = bits(shared_f);
  if ((set & f.spread) != 0) return true;
  const int first = set != 0 ? std::countr_zero(set) : 0;
  const uint32_t rest = set & (set - 1);
  const glm::vec3 base = corner(f, first);
  const Seen seen_f(f, shared_f, base), seen_g(g, shared_g, base);
  const float size = f.size + g.size;
  const auto margin_of = [size](const glm::vec3& normal) {
    return kClear * size * (std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z));
  };
  if (set == 0) {
    // Turning keeps the normal's length and with it the margin; the sum of its components at most
    // doubles.
    const glm::vec3 normal = g.sum - f.sum;
    return turn_until_separated(seen_f, seen_g, normal, 2.0f * margin_of(normal), false, kTurns);
  }
  // Half-way between the directions of the faces, independent of their size.
  glm::vec3 to_f = f.sum - 4.0f * base, to_g = g.sum - 4.0f * base;
  if (rest == 0) {
    const glm::vec3 normal = to_g * length_of(to_f) - to_f * length_of(to_g);
    return turn_until_separated(seen_f, seen_g, normal, 2.0f * margin_of(normal), true, kTurns);
  }
  if ((rest & (rest - 1)) != 0) {
    return false;
  }
  const glm::vec3 edge = corner(f, std::countr_zero(rest)) - base;
  const float squared = glm::dot(edge, edge);
  to_f -= edge * (glm::dot(to_f, edge) / squared);
  to_g -= edge * (glm::dot(to_g, edge) / squared);
  const glm::vec3 normal = to_g * length_of(to_f) - to_f * length_of(to_g);
  // Tilts the plane by its distance from the edge's other end.
  const float margin = margin_of(normal);
  const float tilt = (margin + std::abs(glm::dot(normal, edge))) * size / std::sqrt(squared);
  return turn_until_separated(seen_f, seen_g, normal, margin + tilt, true, 0);
}

/// Whether all corners of `g`, except those shared with a triangle of `f`, are clear of that
/// triangle's plane on one side, for both triangles: decides most pairs of a large and a small
/// face.
bool on_one_side(const CrossingFace& f, const CrossingFace& g) {
  const Corners of_f = points(f), of_g = points(g);
  const double size = f.size;
  const double margin = kClearDouble * size * size * (size + static_cast<double>(g.size));
  for (const auto& triangle : kTriangles) {
    const glm::dvec3& base = of_f[triangle[0]];
    const glm::dvec3 normal = glm::cross(of_f[triangle[1]] - base, of_f[triangle[2]] - base);
    double lowest = 1e300, highest = -1e300;
    for (int k = 0; k < 4; ++k) {
      const int32_t v = g.corners[k];
      if (v != f.corners[triangle[0]] && v != f.corners[triangle[1]] &&
          v != f.corners[triangle[2]]) {
        const double height = glm::dot(normal, of_g[k] - base);
        lowest = std::min(lowest, height);
        highest = std::max(highest, height);
      }
    }
    if (!(lowest > margin || highest < -margin)) {
      return false;
    }
  }
  return true;
}

/// The exact test of all four pairs of triangles.
bool quads_cross(const CrossingFace& f, const CrossingFace& g) {
  const Corners of_f = points(f), of_g = points(g);
  for (const auto& i : kTriangles) {
    const Triangle a = {of_f[i[0]], of_f[i[1]], of_f[i[2]]};
    for (const auto& j : kTriangles) {
      const Triangle b = {of_g[j[0]], of_g[j[1]], of_g[j[2]]};
      std::array<int, 3> shared = {-1, -1, -1};
      for (int k = 0; k < 3; ++k) {
        for (int l = 0; l < 3; ++l) {
          if (f.corners[i[k]] == g.corners[j[l]]) {
            shared[k] = l;
          }
        }
      }
      if (triangles_cross(a, b, shared)) {
        return true;
      }
    }
  }
  return false;
}

}  // namespace

CrossingFace make_crossing_face(std::span<const glm::dvec3> vertices, std::span<const Quad> quads,
                                int32_t number) {
  CrossingFace face{};
  face.number = number;
  face.low = glm::vec3(kUnbounded);
  face.high = glm::vec3(-kUnbounded);
  for (int k = 0; k < 4; ++k) {
    const int32_t v = quads[number][k];
    const glm::vec3 p(vertices[v]);
    face.corners[k] = v;
    face.x[k] = p.x;
    face.y[k] = p.y;
    face.z[k] = p.z;
    face.sum += p;
    face.low = glm::min(face.low, p);
    face.high = glm::max(face.high, p);
  }
  const glm::vec3 extent = face.high - face.low;
  face.size = extent.x + extent.y + extent.z;
  return face;
}

void find_spread_corners(size_t vertex_count, std::span<CrossingFace> faces) {
  /// The faces with a corner at a vertex, as 4 face + corner, and their number.
  struct Around {
    std::array<int32_t, kMaxAround> corners;
    size_t count = 0;
  };
  std::vector<Around> around(vertex_count);
  std::vector<CornerAreas> areas(faces.size());
  for (size_t f = 0; f < faces.size(); ++f) {
    areas[f] = corner_areas(faces[f]);
    for (int k = 0; k < 4; ++k) {
      Around& own = around[faces[f].corners[k]];
      if (own.count < kMaxAround) own.corners[own.count] = static_cast<int32_t>(4 * f) + k;
      ++own.count;
    }
  }
  for (const Around& own : around) {
    if (own.count < 3 || own.count > kMaxAround) continue;
    const std::span<const int32_t> corners(own.corners.data(), own.count);
    if (!is_spread(faces, areas, corners)) continue;
    for (const int32_t corner : corners) faces[corner / 4].spread |= 1u << (corner % 4);
  }
}

bool faces_cross(const CrossingFace& f, const CrossingFace& g) {
  return !separated(f, g) && !on_one_side(f, g) && !on_one_side(g, f) && quads_cross(f, g);
}

}  // namespace snowbough::tree
