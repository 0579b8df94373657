#include "snow/texels/charts.h"

#include <algorithm>
#include <cmath>

#include "base/union_find.h"

namespace snowbough::snow {
namespace {

/// Layout tools write one UV per corner and copy it along an edge; larger differences are cuts.
constexpr float kSameUv = 1e-6f;

struct EdgeRecord {
  int32_t low_vertex;
  int32_t high_vertex;
  int32_t triangle;
  /// Edge number, with bit 4 set if it runs from the higher to the lower index.
  int32_t edge_and_direction;

  int32_t edge() const { return edge_and_direction & 3; }
  bool reversed() const { return (edge_and_direction & 4) != 0; }
  bool same_edge(const EdgeRecord& other) const {
    return low_vertex == other.low_vertex && high_vertex == other.high_vertex;
  }
};

std::vector<EdgeRecord> sorted_edges(const MapTopology& topology) {
  std::vector<EdgeRecord> edges;
  edges.reserve(topology.triangles.size());
  const auto triangle_count = static_cast<int32_t>(topology.triangles.size() / 3);
  for (int32_t t = 0; t < triangle_count; ++t) {
    const int32_t* corner = topology.triangles.data() + 3 * static_cast<ptrdiff_t>(t);
    for (int32_t k = 0; k < 3; ++k) {
      const int32_t from = corner[k];
      const int32_t to = corner[(k + 1) % 3];
      edges.push_back({std::min(from, to), std::max(from, to), t, k | (from > to ? 4 : 0)});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const EdgeRecord& a, const EdgeRecord& b) {
    if (a.low_vertex != b.low_vertex) return a.low_vertex < b.low_vertex;
    if (a.high_vertex != b.high_vertex) return a.high_vertex < b.high_vertex;
    if (a.triangle != b.triangle) return a.triangle < b.triangle;
    return a.edge() < b.edge();
  });
  return edges;
}

/// UVs at the edge's lower and higher vertex index.
struct EdgeUv {
  glm::vec2 low;
  glm::vec2 high;
};

EdgeUv edge_uv(const MapTopology& topology, const EdgeRecord& record) {
  const glm::vec2* uv = topology.corner_uv.data() + 3 * static_cast<ptrdiff_t>(record.triangle);
  const glm::vec2 from = uv[record.edge()];
  const glm::vec2 to = uv[(record.edge() + 1) % 3];
  return record.reversed() ? EdgeUv{to, from} : EdgeUv{from, to};
}

bool same_uv(glm::vec2 a, glm::vec2 b) {
  return std::abs(a.x - b.x) <= kSameUv && std::abs(a.y - b.y) <= kSameUv;
}

}  // namespace

Charts find_charts(const MapTopology& topology) {
  const auto triangle_count = static_cast<int32_t>(topology.triangles.size() / 3);
  const std::vector<EdgeRecord> edges = sorted_edges(topology);
  base::UnionFind sets(static_cast<size_t>(triangle_count));
  Charts charts;

  for (size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
    end = begin + 1;
    while (end < edges.size() && edges[end].same_edge(edges[begin])) ++end;
    // Where more than two triangles meet, those with equal UVs are still neighbours in the layout.
    std::vector<bool> joined(end - begin, false);
    for (size_t i = begin; i < end; ++i) {
      const EdgeUv uv_i = edge_uv(topology, edges[i]);
      // Long fans of triangles on one edge are compared with their next few only, which avoids
      // quadratic time.
      for (size_t j = i + 1; j < std::min(end, i + 16); ++j) {
        const EdgeUv uv_j = edge_uv(topology, edges[j]);
        if (!same_uv(uv_i.low, uv_j.low) || !same_uv(uv_i.high, uv_j.high)) continue;
        sets.join(edges[i].triangle, edges[j].triangle);
        joined[i - begin] = joined[j - begin] = true;
      }
    }
    if (end - begin == 2 && !joined[0] && edges[begin].triangle != edges[begin + 1].triangle) {
      const EdgeRecord& a = edges[begin];
      const EdgeRecord& b = edges[begin + 1];
      charts.seams.push_back(
          {{a.triangle, a.edge()}, {b.triangle, b.edge()}, a.reversed() == b.reversed()});
      continue;
    }
    for (size_t i = begin; i < end; ++i) {
      if (!joined[i - begin]) charts.open_edges.push_back({edges[i].triangle, edges[i].edge()});
    }
  }

  charts.chart.resize(static_cast<size_t>(triangle_count));
  for (int32_t t = 0; t < triangle_count; ++t) {
    const int32_t root = sets.find(t);
    charts.chart[t] = root == t ? charts.count++ : charts.chart[root];
  }
  return charts;
}

}  // namespace snowbough::snow
