#include "tree/kept/charts.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <queue>
#include <tuple>
#include <utility>

namespace snowbough::tree {
namespace {

/// Cosine of the largest angle between a polygon and its chart's first polygon, or its mean.
constexpr double kFacing = 0.6;
constexpr double kFacingMean = 0.75;
/// Farthest polygon of a chart from its first one, as a share of the square root of the whole area.
constexpr double kReach = 0.3;
/// Most polygons of a chart: testing its outline for folds takes quadratic time.
constexpr size_t kMaxPolygons = 180;

struct Side {
  int32_t low, high, face;
};

/// Neighbours over edges: of face f, neighbours[begin[f] .. begin[f + 1]).
struct Neighbours {
  std::vector<int32_t> begin;
  std::vector<int32_t> faces;
};

Neighbours find_neighbours(const KeptSurface& kept) {
  std::vector<Side> sides;
  const auto count = static_cast<int32_t>(kept.face_begin.size()) - 1;
  for (int32_t f = 0; f < count; ++f) {
    const int32_t begin = kept.face_begin[f], end = kept.face_begin[f + 1];
    for (int32_t c = begin; c < end; ++c) {
      const auto [low, high] =
          std::minmax(kept.corner_vertex[c], kept.corner_vertex[c + 1 < end ? c + 1 : begin]);
      sides.push_back({low, high, f});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.low, a.high, a.face) < std::tie(b.low, b.high, b.face);
  });
  std::vector<std::pair<int32_t, int32_t>> pairs;
  for (size_t i = 0; i + 1 < sides.size(); ++i) {
    for (size_t j = i + 1;
         j < sides.size() && sides[j].low == sides[i].low && sides[j].high == sides[i].high; ++j) {
      if (sides[i].face == sides[j].face) continue;
      pairs.emplace_back(sides[i].face, sides[j].face);
      pairs.emplace_back(sides[j].face, sides[i].face);
    }
  }
  std::sort(pairs.begin(), pairs.end());
  Neighbours result;
  result.begin.assign(static_cast<size_t>(count) + 1, 0);
  for (const auto& [from, to] : pairs) {
    ++result.begin[from + 1];
    result.faces.push_back(to);
  }
  for (int32_t f = 0; f < count; ++f) result.begin[f + 1] += result.begin[f];
  return result;
}

struct Facet {
  glm::dvec3 centre{0.0};
  /// Area and direction.
  glm::dvec3 normal{0.0};
};

std::vector<Facet> facets_of(const KeptSurface& kept) {
  std::vector<Facet> facets;
  for (size_t f = 0; f + 1 < kept.face_begin.size(); ++f) {
    Facet facet;
    const auto place = [&](int32_t c) { return glm::dvec3(kept.vertices[kept.corner_vertex[c]]); };
    const int32_t begin = kept.face_begin[f], end = kept.face_begin[f + 1];
    for (int32_t c = begin; c < end; ++c) facet.centre += place(c) / double(end - begin);
    for (int32_t c = begin + 1; c + 1 < end; ++c) {
      facet.normal += 0.5 * glm::cross(place(c) - place(begin), place(c + 1) - place(begin));
    }
    facets.push_back(facet);
  }
  return facets;
}

/// Whether two directions, of any length, are within an angle of the given cosine.
bool faces_alike(const glm::dvec3& a, const glm::dvec3& b, double cosine) {
  return glm::dot(a, b) >= cosine * glm::length(a) * glm::length(b);
}

}  // namespace

std::vector<int32_t> grow_charts(const KeptSurface& kept) {
  const Neighbours neighbours = find_neighbours(kept);
  const std::vector<Facet> facets = facets_of(kept);
  double area = 0.0;
  for (const Facet& facet : facets) area += glm::length(facet.normal);
  const double reach = kReach * std::sqrt(area);
  const auto branch_of = [&](int32_t f) {
    return kept.vertex_branch[kept.corner_vertex[kept.face_begin[f]]];
  };
  std::vector<int32_t> chart(facets.size(), -1);
  int32_t count = 0;
  using Next = std::pair<double, int32_t>;
  for (size_t seed = 0; seed < facets.size(); ++seed) {
    if (chart[seed] >= 0) continue;
    glm::dvec3 sum(0.0);
    size_t polygons = 0;
    // The nearest first, so that the chart is compact.
    std::priority_queue<Next, std::vector<Next>, std::greater<>> open;
    open.emplace(0.0, static_cast<int32_t>(seed));
    while (!open.empty() && polygons < kMaxPolygons) {
      const auto [away, f] = open.top();
      open.pop();
      if (chart[f] >= 0 || !faces_alike(facets[f].normal, sum, kFacingMean)) continue;
      chart[f] = count;
      sum += facets[f].normal;
      ++polygons;
      for (int32_t i = neighbours.begin[f]; i < neighbours.begin[f + 1]; ++i) {
        const int32_t other = neighbours.faces[i];
        const double distance = glm::distance(facets[other].centre, facets[seed].centre);
        if (chart[other] < 0 && distance <= reach &&
            branch_of(other) == branch_of(static_cast<int32_t>(seed)) &&
            faces_alike(facets[other].normal, facets[seed].normal, kFacing)) {
          open.emplace(distance, other);
        }
      }
    }
    ++count;
  }
  return chart;
}

}  // namespace snowbough::tree
