#include "render/snow/snow_patches.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <queue>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>

#include "render/snow/bend.h"

namespace snowbough::render {
namespace {

using glm::vec2;
using glm::vec3;
using glm::vec4;

/// Texels that an edge of a patch may cover: the tessellator cuts it into 64 parts at most, which
/// is two a texel.
constexpr float kMostTexels = 32.0f;
/// Cosine from which on two normals are one, and how far places on the map may differ and be one.
constexpr float kSameNormal = 0.9998f;
constexpr float kSameUv = 1e-6f;

void require(bool right, const std::string& what) {
  if (!right) throw std::invalid_argument("add_snow_mesh: " + what);
}

bool is_finite(const vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

void check_pose(const std::vector<vec3>& positions, const std::vector<std::array<vec3, 3>>& normals,
                size_t vertices, size_t triangles) {
  require(positions.size() == vertices, "there must be " + std::to_string(vertices) +
                                            " positions, not " + std::to_string(positions.size()));
  require(normals.empty() || normals.size() == triangles,
          "normals must have shape (T, 3, 3), one a corner of each triangle");
  for (size_t v = 0; v < positions.size(); ++v) {
    require(is_finite(positions[v]), "position " + std::to_string(v) + " is not finite");
  }
}

void check(const SnowSource& source) {
  require(!source.triangles.empty(), "the mesh has no triangles");
  require(source.uv.size() == source.triangles.size(),
          "uv must have shape (T, 3, 2), one place a corner of each triangle");
  require(source.resolution >= 1 && source.resolution <= 8192, "resolution must be from 1 to 8192");
  check_pose(source.positions, source.normals, source.positions.size(), source.triangles.size());
  for (size_t t = 0; t < source.triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int32_t v = source.triangles[t][k];
      require(v >= 0 && v < static_cast<int32_t>(source.positions.size()),
              "triangle " + std::to_string(t) + " names vertex " + std::to_string(v) + " of " +
                  std::to_string(source.positions.size()));
      const vec2 uv = source.uv[t][k];
      require(uv.x > -1e-4f && uv.y > -1e-4f && uv.x < 1.0001f && uv.y < 1.0001f,
              "triangle " + std::to_string(t) + " lies outside of the map, which is 0 to 1");
    }
  }
}

vec3 unit(const vec3& v, const vec3& otherwise) {
  const float length = glm::length(v);
  return length > 1e-20f ? v / length : otherwise;
}

float texels_between(const vec2& a, const vec2& b, int32_t resolution) {
  return glm::distance(a, b) * static_cast<float>(resolution);
}

vec2 corner_uv(const shared::SnowPatch& patch, int32_t k) {
  return k == 0   ? vec2(patch.uv_01.x, patch.uv_01.y)
         : k == 1 ? vec2(patch.uv_01.z, patch.uv_01.w)
                  : vec2(patch.uv_2.x, patch.uv_2.y);
}

/// A side of a triangle, by its lower vertex first.
struct Side {
  int32_t a, b, triangle, corner;
  bool operator<(const Side& other) const {
    return std::tie(a, b, triangle, corner) <
           std::tie(other.a, other.b, other.triangle, other.corner);
  }
};

std::vector<Side> sorted_sides(const std::vector<std::array<int32_t, 3>>& triangles) {
  std::vector<Side> sides;
  for (size_t t = 0; t < triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int32_t from = triangles[t][k], to = triangles[t][(k + 1) % 3];
      sides.push_back({std::min(from, to), std::max(from, to), static_cast<int32_t>(t), k});
    }
  }
  std::sort(sides.begin(), sides.end());
  return sides;
}

/// The edge of a kind that is nearest to a vertex along the surface.
struct NearestEdge {
  int32_t edge = -1;
  float away = shared::kNoRim;
  /// Share of the edge at which it is nearest.
  float along = 0.0f;
};

NearestEdge measured(const SnowPatches& mesh, int32_t edge, int32_t vertex) {
  const vec3 a = vec3(mesh.vertices[mesh.edges[edge].ends.x].position);
  const vec3 whole = vec3(mesh.vertices[mesh.edges[edge].ends.y].position) - a;
  const vec3 p = vec3(mesh.vertices[vertex].position);
  const float along =
      glm::clamp(glm::dot(p - a, whole) / std::max(glm::dot(whole, whole), 1e-30f), 0.0f, 1.0f);
  return {edge, glm::distance(p, a + along * whole), along};
}

/// Hands edges on from vertex to vertex, nearest first, as Dijkstra's shortest paths do; distances
/// are straight.
std::vector<NearestEdge> nearest_edges(const SnowPatches& mesh,
                                       const std::vector<uint8_t>& wanted) {
  std::vector<NearestEdge> nearest(mesh.vertices.size());
  std::vector<std::vector<int32_t>> neighbours(mesh.vertices.size());
  using Offer = std::tuple<float, int32_t, int32_t>;
  std::priority_queue<Offer, std::vector<Offer>, std::greater<>> offers;
  const auto offer = [&](int32_t edge, int32_t vertex) {
    const NearestEdge found = measured(mesh, edge, vertex);
    // Refuses NaN as well, which would be handed on for ever.
    if (!(found.away < nearest[vertex].away)) return;
    nearest[vertex] = found;
    offers.push({found.away, vertex, edge});
  };
  for (size_t e = 0; e < mesh.edges.size(); ++e) {
    const glm::ivec4& ends = mesh.edges[e].ends;
    neighbours[ends.x].push_back(ends.y);
    neighbours[ends.y].push_back(ends.x);
    if (wanted[e] == 0) continue;
    offer(static_cast<int32_t>(e), ends.x);
    offer(static_cast<int32_t>(e), ends.y);
  }
  while (!offers.empty()) {
    const auto [away, vertex, edge] = offers.top();
    offers.pop();
    if (edge != nearest[vertex].edge) continue;
    for (const int32_t other : neighbours[vertex]) offer(edge, other);
  }
  return nearest;
}

}  // namespace

SnowMesh::SnowMesh(SnowSource source) : source_(std::move(source)) {
  check(source_);
  refined_ = refine(source_, source_.resolution, kMostTexels);
  add_patches();
  patches_.vertices.resize(refined_.vertex_parents.size());
  patches_.corner_normals.resize(3 * refined_.triangles.size());
  const auto directions = growth_directions(source_);
  take_pose(directions);
  for (shared::SnowVertex& vertex : patches_.vertices) vertex.rest = vertex.position;
  add_edges();
  find_bends(source_, refined_, directions, patches_);
  list_corners();
  measure_rims();
}

void SnowMesh::set_pose(const std::vector<vec3>& positions,
                        const std::vector<std::array<vec3, 3>>& normals) {
  check_pose(positions, normals, source_.positions.size(), source_.triangles.size());
  source_.positions = positions;
  source_.normals = normals;
  const auto directions = growth_directions(source_);
  take_pose(directions);
  find_bends(source_, refined_, directions, patches_);
}

void SnowMesh::add_patches() {
  for (size_t t = 0; t < refined_.triangles.size(); ++t) {
    const auto& uv = source_.uv[refined_.source_triangle[t]];
    std::array<vec2, 3> at;
    for (int k = 0; k < 3; ++k) {
      const vec3 w = refined_.corner_weights[t][k];
      at[k] = w.x * uv[0] + w.y * uv[1] + w.z * uv[2];
    }
    const auto& v = refined_.triangles[t];
    shared::SnowPatch patch{};
    patch.vertices = {v[0], v[1], v[2], 0};
    patch.uv_01 = vec4(at[0], at[1]);
    patch.uv_2 = vec4(at[2], 0.0f, 0.0f);
    patches_.patches.push_back(patch);
  }
}

void SnowMesh::take_pose(const std::vector<std::array<vec3, 3>>& directions) {
  for (size_t v = 0; v < patches_.vertices.size(); ++v) {
    const auto& parents = refined_.vertex_parents[v];
    const vec3 w = refined_.vertex_weights[v];
    const vec3 p = w.x * source_.positions[parents[0]] + w.y * source_.positions[parents[1]] +
                   w.z * source_.positions[parents[2]];
    patches_.vertices[v].position = vec4(p, 0.0f);
  }
  std::vector<vec2> lengths(patches_.vertices.size(), vec2(0.0f));
  for (size_t t = 0; t < refined_.triangles.size(); ++t) {
    const int32_t source = refined_.source_triangle[t];
    const auto& corners = source_.triangles[source];
    const vec3 a = source_.positions[corners[0]];
    const vec3 flat =
        unit(glm::cross(source_.positions[corners[1]] - a, source_.positions[corners[2]] - a),
             vec3(0.0f, 0.0f, 1.0f));
    for (int k = 0; k < 3; ++k) {
      const vec3 w = refined_.corner_weights[t][k];
      vec3 normal(0.0f);
      for (int j = 0; j < 3; ++j) normal += w[j] * directions[source][j];
      patches_.corner_normals[3 * t + k] = vec4(unit(normal, flat), 0.0f);
      const int32_t from = refined_.triangles[t][k], to = refined_.triangles[t][(k + 1) % 3];
      const vec2 length(
          glm::distance(vec3(patches_.vertices[from].position),
                        vec3(patches_.vertices[to].position)),
          texels_between(corner_uv(patches_.patches[t], k),
                         corner_uv(patches_.patches[t], (k + 1) % 3), source_.resolution));
      lengths[from] += length;
      lengths[to] += length;
    }
  }
  patches_.lowest = patches_.highest = vec3(patches_.vertices[0].position);
  for (size_t v = 0; v < patches_.vertices.size(); ++v) {
    vec4& position = patches_.vertices[v].position;
    position.w = lengths[v].y > 0.0f ? lengths[v].x / lengths[v].y : 0.0f;
    patches_.lowest = glm::min(patches_.lowest, vec3(position));
    patches_.highest = glm::max(patches_.highest, vec3(position));
  }
}

void SnowMesh::add_edges() {
  const std::vector<Side> sides = sorted_sides(refined_.triangles);
  for (size_t i = 0; i < sides.size();) {
    size_t end = i + 1;
    while (end < sides.size() && sides[end].a == sides[i].a && sides[end].b == sides[i].b) ++end;
    require(end - i <= 2, "the edge of vertices " + std::to_string(sides[i].a) + " and " +
                              std::to_string(sides[i].b) + " has more than two triangles");
    const bool is_open = end - i == 1;
    const std::array<Side, 2> both{sides[i], is_open ? sides[i] : sides[i + 1]};
    shared::SnowEdge edge{};
    std::array<std::array<int32_t, 2>, 2> corners{};
    std::array<std::array<vec2, 2>, 2> uv{};
    const auto index = static_cast<int32_t>(patches_.edges.size());
    float texels = 0.0f;
    for (int s = 0; s < 2; ++s) {
      const Side& side = both[s];
      shared::SnowPatch& patch = patches_.patches[side.triangle];
      const bool reversed = refined_.triangles[side.triangle][side.corner] != side.a;
      const int32_t from = reversed ? (side.corner + 1) % 3 : side.corner;
      const int32_t to = reversed ? side.corner : (side.corner + 1) % 3;
      corners[s] = {3 * side.triangle + from, 3 * side.triangle + to};
      uv[s] = {corner_uv(patch, from), corner_uv(patch, to)};
      texels = std::max(texels, texels_between(uv[s][0], uv[s][1], source_.resolution));
      patch.edges[side.corner] = 2 * index + (reversed ? 1 : 0);
    }
    edge.ends = {both[0].a, both[0].b, is_open ? 1 : 0, 0};
    edge.corners = {corners[0][0], corners[0][1], corners[1][0], corners[1][1]};
    edge.uv = vec4(uv[0][0], uv[0][1]);
    edge.other_uv = vec4(uv[1][0], uv[1][1]);
    edge.metric = vec4(texels, 0.0f, 0.0f, 0.0f);
    patches_.edges.push_back(edge);
    i = end;
  }
}

void SnowMesh::list_corners() {
  std::vector<std::vector<int32_t>> around(patches_.vertices.size());
  const auto is_same = [&](int32_t one, int32_t other) {
    const vec2 apart = glm::abs(corner_uv(patches_.patches[one / 3], one % 3) -
                                corner_uv(patches_.patches[other / 3], other % 3));
    return std::max(apart.x, apart.y) < kSameUv &&
           glm::dot(vec3(patches_.corner_normals[one]), vec3(patches_.corner_normals[other])) >
               kSameNormal;
  };
  for (int32_t corner = 0; corner < static_cast<int32_t>(patches_.corner_normals.size());
       ++corner) {
    auto& known = around[refined_.triangles[corner / 3][corner % 3]];
    const bool is_new = std::none_of(known.begin(), known.end(),
                                     [&](int32_t other) { return is_same(corner, other); });
    if (is_new) known.push_back(corner);
  }
  for (size_t v = 0; v < around.size(); ++v) {
    // A vertex without a triangle is never drawn; any corner stands for it.
    if (around[v].empty()) around[v].push_back(0);
    shared::SnowVertex& vertex = patches_.vertices[v];
    vertex.corners.x = static_cast<int32_t>(patches_.vertex_corners.size());
    patches_.vertex_corners.insert(patches_.vertex_corners.end(), around[v].begin(),
                                   around[v].end());
    vertex.corners.y = static_cast<int32_t>(patches_.vertex_corners.size());
  }
}

bool SnowMesh::is_hard(const shared::SnowEdge& edge) const {
  const auto differ = [&](int32_t one, int32_t other) {
    return glm::dot(vec3(patches_.corner_normals[one]), vec3(patches_.corner_normals[other])) <
           kSameNormal;
  };
  return differ(edge.corners.x, edge.corners.z) || differ(edge.corners.y, edge.corners.w);
}

void SnowMesh::measure_rims() {
  std::vector<uint8_t> hard, open;
  for (const shared::SnowEdge& edge : patches_.edges) {
    hard.push_back(is_hard(edge) ? 1 : 0);
    open.push_back(edge.ends.z != 0 ? 1 : 0);
  }
  const std::vector<NearestEdge> to_hard = nearest_edges(patches_, hard);
  const std::vector<NearestEdge> to_end = nearest_edges(patches_, open);
  for (size_t v = 0; v < patches_.vertices.size(); ++v) {
    shared::SnowVertex& vertex = patches_.vertices[v];
    vertex.corners.z = to_hard[v].edge;
    vertex.rims = vec4(to_hard[v].away, to_hard[v].along, to_end[v].away, 0.0f);
  }
}

}  // namespace snowbough::render
