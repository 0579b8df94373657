#include "tree/welded/geodesic.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <limits>
#include <queue>
#include <tuple>
#include <utility>

namespace snowbough::tree {
namespace {

/// Progress at which the links are found; and vertices between two progress reports.
constexpr float kLinksFound = 0.6f;
constexpr size_t kAskEvery = 16384;

struct Link {
  int32_t from = 0, to = 0;
  double length = 0.0;
};

glm::dvec3 position(const LocalMesh& mesh, int32_t vertex) {
  return glm::dvec3(mesh.positions[vertex]);
}

/// Length of the straight path from c to d across their triangles' common edge a, b, unfolded;
/// negative if it would leave them.
double across_edge(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c,
                   const glm::dvec3& d) {
  const double length = glm::distance(a, b);
  if (length <= 0.0) return -1.0;
  const glm::dvec3 axis = (b - a) / length;
  const double c_along = glm::dot(c - a, axis);
  const double d_along = glm::dot(d - a, axis);
  const double c_off = glm::length(c - a - axis * c_along);
  const double d_off = glm::length(d - a - axis * d_along);
  if (c_off + d_off <= 0.0) return -1.0;
  const double crossing = c_along + (d_along - c_along) * c_off / (c_off + d_off);
  if (crossing < 0.0 || crossing > length) return -1.0;
  return std::hypot(c_along - d_along, c_off + d_off);
}

/// Both directions of every link.
std::vector<Link> find_links(const LocalMesh& mesh, const std::vector<LocalTriangle>& triangles) {
  std::vector<Link> links;
  const auto add = [&](int32_t a, int32_t b, double length) {
    links.push_back({a, b, length});
    links.push_back({b, a, length});
  };
  // Edge, and the corner across.
  std::vector<std::tuple<int32_t, int32_t, int32_t>> sides;
  for (const LocalTriangle& t : triangles) {
    for (int k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(t[k], t[(k + 1) % 3]);
      sides.emplace_back(low, high, t[(k + 2) % 3]);
    }
  }
  std::sort(sides.begin(), sides.end());
  for (size_t i = 0; i < sides.size();) {
    const auto [a, b, c] = sides[i];
    add(a, b, glm::distance(position(mesh, a), position(mesh, b)));
    size_t j = i + 1;
    while (j < sides.size() && std::get<0>(sides[j]) == a && std::get<1>(sides[j]) == b) ++j;
    if (j == i + 2) {
      const int32_t d = std::get<2>(sides[i + 1]);
      const double length =
          across_edge(position(mesh, a), position(mesh, b), position(mesh, c), position(mesh, d));
      if (length >= 0.0) add(c, d, length);
    }
    i = j;
  }
  std::sort(links.begin(), links.end(), [](const Link& v, const Link& w) {
    return std::tie(v.from, v.to, v.length) < std::tie(w.from, w.to, w.length);
  });
  return links;
}

}  // namespace

std::vector<LocalTriangle> triangulate(const LocalMesh& mesh) {
  std::vector<LocalTriangle> triangles;
  for (int32_t f = 0; f < mesh.face_count(); ++f) {
    const std::span<const int32_t> face = mesh.face(f);
    for (size_t c = 1; c + 1 < face.size(); ++c) {
      triangles.push_back({face[0], face[c], face[c + 1]});
    }
  }
  return triangles;
}

std::vector<std::array<int32_t, 2>> edges_of(const std::vector<LocalTriangle>& triangles) {
  std::vector<std::array<int32_t, 2>> edges;
  edges.reserve(3 * triangles.size());
  for (const LocalTriangle& t : triangles) {
    for (int k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(t[k], t[(k + 1) % 3]);
      if (low != high) edges.push_back({low, high});
    }
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

std::vector<double> geodesic_distances(const LocalMesh& mesh,
                                       const std::vector<LocalTriangle>& triangles,
                                       std::span<const int32_t> sources,
                                       const base::Progress& progress) {
  base::report_progress(progress, 0.0f);
  const std::vector<Link> links = find_links(mesh, triangles);
  std::vector<size_t> begin(mesh.positions.size() + 1, 0);
  for (const Link& link : links) ++begin[link.from + 1];
  for (size_t v = 0; v + 1 < begin.size(); ++v) begin[v + 1] += begin[v];

  std::vector<double> distance(mesh.positions.size(), std::numeric_limits<double>::infinity());
  using Reached = std::pair<double, int32_t>;
  std::priority_queue<Reached, std::vector<Reached>, std::greater<>> queue;
  for (const int32_t v : sources) {
    distance[v] = 0.0;
    queue.emplace(0.0, v);
  }
  base::report_progress(progress, kLinksFound);
  const base::Progress walk = base::part_of(progress, kLinksFound, 1.0f);
  size_t reached = 0;
  while (!queue.empty()) {
    const auto [at, v] = queue.top();
    queue.pop();
    if (at > distance[v]) continue;
    if (++reached % kAskEvery == 0) {
      base::report_progress(
          walk, std::min(1.0f, static_cast<float>(reached) / static_cast<float>(distance.size())));
    }
    for (size_t i = begin[v]; i < begin[v + 1]; ++i) {
      const double there = at + links[i].length;
      if (there < distance[links[i].to]) {
        distance[links[i].to] = there;
        queue.emplace(there, links[i].to);
      }
    }
  }
  return distance;
}

}  // namespace snowbough::tree
