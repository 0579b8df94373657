#include "snow/surface/surface_mesh.h"

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <unordered_map>

#include "base/group_by_key.h"
#include "base/parallel_for.h"
#include "snow/surface/vectors.h"
#include "snow/texels/merge_vertices.h"

namespace snowbough::snow {
namespace {

using Triangle = std::array<int32_t, 3>;

/// Angle of a triangle at corner k.
float angle_at(const std::array<glm::vec3, 3>& corners, int k) {
  const glm::vec3 a = unit(corners[(k + 1) % 3] - corners[k]);
  const glm::vec3 b = unit(corners[(k + 2) % 3] - corners[k]);
  return std::acos(glm::clamp(glm::dot(a, b), -1.0f, 1.0f));
}

/// A normal for each corner of the source. Smooth corners share the mean normal of their number;
/// flat corners have the normal of their face. Faces are weighted by their angle at the corner (G.
/// Thuermer, C. A. Wuethrich, Computing Vertex Normals from Polygonal Facets, JGT 3, 1998).
std::vector<glm::vec3> corner_normals(const SurfaceSource& source) {
  const size_t corners = source.topology.triangles.size();
  std::vector<glm::vec3> normals(corners);
  std::unordered_map<int32_t, glm::vec3> sums;
  const auto shared = [&](size_t c) { return source.shading.empty() ? -1 : source.shading[c]; };
  for (size_t t = 0; t * 3 < corners; ++t) {
    std::array<glm::vec3, 3> at;
    for (int k = 0; k < 3; ++k) {
      at[k] = source.positions[source.topology.triangles[t * 3 + k]];
    }
    const glm::vec3 normal = unit(glm::cross(at[1] - at[0], at[2] - at[0]));
    for (int k = 0; k < 3; ++k) {
      normals[t * 3 + k] = normal;
      if (const int32_t number = shared(t * 3 + k); number >= 0) {
        sums.try_emplace(number, 0.0f).first->second += normal * angle_at(at, k);
      }
    }
  }
  for (size_t c = 0; c < corners; ++c) {
    if (const int32_t number = shared(c); number >= 0) normals[c] = unit(sums.at(number));
  }
  return normals;
}

/// A triangle with split edges: points and texture coordinates of its corners and of the splits.
struct SplitTriangle {
  std::array<int32_t, 6> point;
  std::array<glm::vec2, 6> uv;
  std::array<glm::vec3, 6> normal;
};

/// Appends the parts of a split triangle to a mesh.
class Parts {
 public:
  explicit Parts(SurfaceMesh& mesh) : mesh_(mesh) {}
  void add(const SplitTriangle& whole, int32_t base, int a, int b, int c) {
    mesh_.triangle.push_back({whole.point[a], whole.point[b], whole.point[c]});
    mesh_.uv.push_back({whole.uv[a], whole.uv[b], whole.uv[c]});
    mesh_.normal.push_back({whole.normal[a], whole.normal[b], whole.normal[c]});
    mesh_.base.push_back(base);
  }

 private:
  SurfaceMesh& mesh_;
};

}  // namespace

SurfaceEdges surface_edges(const std::vector<Triangle>& triangles) {
  // Sides in order of their lower vertex (a counting sort), then of their upper one.
  struct Side {
    int32_t upper;
    uint32_t corner;
  };
  int32_t vertices = 0;
  for (const Triangle& t : triangles) vertices = std::max({vertices, t[0] + 1, t[1] + 1, t[2] + 1});
  const auto for_sides = [&](const auto& visit) {
    for (size_t t = 0; t < triangles.size(); ++t) {
      for (uint32_t k = 0; k < 3; ++k) {
        const auto [lower, upper] = std::minmax(triangles[t][k], triangles[t][(k + 1) % 3]);
        visit(static_cast<size_t>(lower), Side{upper, static_cast<uint32_t>(t * 3 + k)});
      }
    }
  };
  std::vector<uint32_t> begin;
  std::vector<Side> sides;
  base::group_by_key(static_cast<size_t>(vertices), for_sides, begin, sides);

  SurfaceEdges edges;
  edges.of_triangle.resize(triangles.size());
  for (int32_t lower = 0; lower < vertices; ++lower) {
    const auto first = sides.begin() + begin[lower], last = sides.begin() + begin[lower + 1];
    std::sort(first, last, [](const Side& a, const Side& b) {
      return a.upper != b.upper ? a.upper < b.upper : a.corner < b.corner;
    });
    for (auto side = first; side != last; ++side) {
      if (side == first || side->upper != (side - 1)->upper)
        edges.ends.push_back({lower, side->upper});
      edges.of_triangle[side->corner / 3][side->corner % 3] =
          static_cast<int32_t>(edges.ends.size()) - 1;
    }
  }
  return edges;
}

glm::vec3 triangle_cross(const SurfaceMesh& mesh, size_t triangle) {
  const auto& [a, b, c] = mesh.triangle[triangle];
  return glm::cross(mesh.position[b] - mesh.position[a], mesh.position[c] - mesh.position[a]);
}

std::vector<glm::vec3> triangle_normals(const SurfaceMesh& mesh) {
  std::vector<glm::vec3> normals(mesh.triangle.size());
  base::for_each_item(normals.size(), 4096,
                      [&](size_t t) { normals[t] = unit(triangle_cross(mesh, t)); });
  return normals;
}

SurfaceMesh receiver_mesh(const SurfaceSource& source) {
  const MapTopology topology = merge_vertices(source.topology, source.positions);
  const std::vector<glm::vec3> normals = corner_normals(source);
  SurfaceMesh mesh;
  mesh.position = source.positions;
  std::vector<uint8_t> keep(topology.triangles.size() / 3);
  for (size_t t = 0; t < keep.size(); ++t) {
    const int32_t* corner = &topology.triangles[t * 3];
    mesh.triangle.push_back({corner[0], corner[1], corner[2]});
    mesh.uv.push_back(
        {topology.corner_uv[t * 3], topology.corner_uv[t * 3 + 1], topology.corner_uv[t * 3 + 2]});
    mesh.normal.push_back({normals[t * 3], normals[t * 3 + 1], normals[t * 3 + 2]});
    mesh.base.push_back(static_cast<int32_t>(t));
    keep[t] = glm::length(triangle_cross(mesh, t)) > 0.0f ? 1 : 0;
  }
  return submesh(mesh, keep);
}

SurfaceMesh submesh(const SurfaceMesh& mesh, const std::vector<uint8_t>& keep) {
  SurfaceMesh part;
  std::vector<int32_t> number(mesh.position.size(), -1);
  for (size_t t = 0; t < mesh.triangle.size(); ++t) {
    if (keep[t] == 0) continue;
    Triangle corners = mesh.triangle[t];
    for (int32_t& corner : corners) {
      if (number[corner] < 0) {
        number[corner] = static_cast<int32_t>(part.position.size());
        part.position.push_back(mesh.position[corner]);
      }
      corner = number[corner];
    }
    part.triangle.push_back(corners);
    part.uv.push_back(mesh.uv[t]);
    part.normal.push_back(mesh.normal[t]);
    part.base.push_back(mesh.base[t]);
  }
  return part;
}

void split_edges(SurfaceMesh& mesh, const SurfaceEdges& edges, const std::vector<float>& share) {
  const auto is_split = [&](int32_t e) { return share[e] > 0.0f && share[e] < 1.0f; };
  std::vector<int32_t> middle(edges.ends.size(), -1);
  for (size_t e = 0; e < edges.ends.size(); ++e) {
    if (!is_split(static_cast<int32_t>(e))) continue;
    const auto [a, b] = edges.ends[e];
    middle[e] = static_cast<int32_t>(mesh.position.size());
    mesh.position.push_back(glm::mix(mesh.position[a], mesh.position[b], share[e]));
  }
  SurfaceMesh whole;
  std::swap(whole.triangle, mesh.triangle);
  std::swap(whole.uv, mesh.uv);
  std::swap(whole.normal, mesh.normal);
  std::swap(whole.base, mesh.base);
  mesh.triangle.reserve(whole.triangle.size() * 2);
  mesh.uv.reserve(whole.triangle.size() * 2);
  mesh.normal.reserve(whole.triangle.size() * 2);
  mesh.base.reserve(whole.triangle.size() * 2);
  Parts parts(mesh);
  for (size_t t = 0; t < whole.triangle.size(); ++t) {
    const Triangle& corner = whole.triangle[t];
    const Triangle& side = edges.of_triangle[t];
    int count = 0;
    int first = 0;
    for (int k = 0; k < 3; ++k) count += is_split(side[k]) ? 1 : 0;
    // With one or two split sides, rotate the corners so that the first split side comes first.
    for (int k = 0; k < 3; ++k) {
      if (is_split(side[k]) && (count != 2 || is_split(side[(k + 1) % 3]))) first = k;
    }
    SplitTriangle split{};
    for (int k = 0; k < 3; ++k) {
      const int from = (first + k) % 3;
      const int to = (from + 1) % 3;
      const int32_t e = side[from];
      split.point[k] = corner[from];
      split.uv[k] = whole.uv[t][from];
      split.point[3 + k] = middle[e];
      const float along = edges.ends[e][0] == corner[from] ? share[e] : 1.0f - share[e];
      split.uv[3 + k] = glm::mix(whole.uv[t][from], whole.uv[t][to], along);
      split.normal[k] = whole.normal[t][from];
      split.normal[3 + k] = unit(glm::mix(whole.normal[t][from], whole.normal[t][to], along));
    }
    const int32_t base = whole.base[t];
    if (count == 0) {
      parts.add(split, base, 0, 1, 2);
    } else if (count == 1) {
      parts.add(split, base, 0, 3, 2);
      parts.add(split, base, 3, 1, 2);
    } else if (count == 2) {
      parts.add(split, base, 3, 1, 4);
      const auto distance = [&](int a, int b) {
        return glm::distance(mesh.position[split.point[a]], mesh.position[split.point[b]]);
      };
      if (distance(3, 2) <= distance(0, 4)) {
        parts.add(split, base, 0, 3, 2);
        parts.add(split, base, 3, 4, 2);
      } else {
        parts.add(split, base, 0, 3, 4);
        parts.add(split, base, 0, 4, 2);
      }
    } else {
      parts.add(split, base, 0, 3, 5);
      parts.add(split, base, 3, 1, 4);
      parts.add(split, base, 5, 4, 2);
      parts.add(split, base, 3, 4, 5);
    }
  }
}

void mark_longest(const SurfaceMesh& mesh, const SurfaceEdges& edges,
                  const std::vector<uint8_t>& spared, std::vector<uint8_t>& marked) {
  const auto length = [&](int32_t e) {
    if (spared[e] != 0) return -1.0f;
    return glm::distance(mesh.position[edges.ends[e][0]], mesh.position[edges.ends[e][1]]);
  };
  std::vector<int32_t> longest(mesh.triangle.size());
  base::for_each_item(longest.size(), 4096, [&](size_t t) {
    const auto& side = edges.of_triangle[t];
    longest[t] = side[0];
    for (int k = 1; k < 3; ++k) {
      const float mine = length(side[k]);
      const float best = length(longest[t]);
      if (mine > best || (mine == best && side[k] < longest[t])) longest[t] = side[k];
    }
  });
  for (bool changed = true; changed;) {
    changed = false;
    for (size_t t = 0; t < mesh.triangle.size(); ++t) {
      const auto& side = edges.of_triangle[t];
      const bool any = marked[side[0]] != 0 || marked[side[1]] != 0 || marked[side[2]] != 0;
      if (any && marked[longest[t]] == 0) {
        marked[longest[t]] = 1;
        changed = true;
      }
    }
  }
}

}  // namespace snowbough::snow
