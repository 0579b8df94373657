#include "tree/detail/creases.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

#include "base/group_by_key.h"

namespace snowbough::tree {
namespace {

/// Cosine of the angle between faces that counts as a crease: 20 degrees.
constexpr double kCrease = 0.9397;
/// Fraction of the distance to the line per step, and maximum number of steps.
constexpr double kStep = 0.5;
constexpr int kCreaseRounds = 24;
/// Tolerance for the ends of an edge across: both are at the same fraction of their row.
constexpr double kLevel = 1e-9;

/// An edge across a limb, and for each of its ends the vertices before and after it.
struct CrossEdge {
  std::array<int32_t, 2> ends{};
  std::array<int32_t, 2> before{}, after{};
  int32_t face_before = -1, face_after = -1;
  bool is_creased = true;
};

/// One of a face's two edges across the limb.
struct HalfEdge {
  std::array<int32_t, 2> ends{}, beside{};
  int32_t face = -1;
  int32_t chain = -1;
};

/// The edges across limbs with a movable end.
std::vector<CrossEdge> cross_edges(const FineMesh& fine, std::span<const FaceOrigin> origins,
                                   const std::vector<int32_t>& chains,
                                   std::span<const double> farthest) {
  std::vector<HalfEdge> halves;
  for (size_t f = 0; f < fine.quads.size(); ++f) {
    const FaceOrigin& origin = origins[fine.face[f]];
    if (origin.part != FacePart::kWall) continue;
    const Quad& quad = fine.quads[f];
    for (int k = 0; k < 4; ++k) {
      const int next = (k + 1) % 4;
      if (std::abs(fine.corners[f][k].y - fine.corners[f][next].y) > kLevel) continue;
      HalfEdge half;
      half.ends = {quad[k], quad[next]};
      half.beside = {quad[(k + 3) % 4], quad[(k + 2) % 4]};
      if (half.ends[0] > half.ends[1]) {
        std::swap(half.ends[0], half.ends[1]);
        std::swap(half.beside[0], half.beside[1]);
      }
      if (farthest[half.ends[0]] <= 0.0 && farthest[half.ends[1]] <= 0.0) continue;
      half.face = static_cast<int32_t>(f);
      half.chain = chains[origin.branch];
      halves.push_back(half);
    }
  }
  // By their ends, then in the order of the faces.
  std::vector<size_t> first;
  std::vector<HalfEdge> sorted;
  const auto for_halves = [&](const auto& visit) {
    for (const HalfEdge& half : halves) visit(half.ends[0], half);
  };
  base::group_by_key(farthest.size(), for_halves, first, sorted);
  std::vector<CrossEdge> edges;
  for (size_t v = 0; v < farthest.size(); ++v) {
    std::stable_sort(sorted.begin() + first[v], sorted.begin() + first[v + 1],
                     [](const HalfEdge& a, const HalfEdge& b) { return a.ends[1] < b.ends[1]; });
    for (size_t i = first[v]; i + 1 < first[v + 1]; ++i) {
      const HalfEdge &a = sorted[i], &b = sorted[i + 1];
      if (a.ends != b.ends || a.chain != b.chain) continue;
      edges.push_back({a.ends, a.beside, b.beside, a.face, b.face});
    }
  }
  return edges;
}

glm::dvec3 normal(const Quad& quad, const std::vector<glm::dvec3>& points) {
  return glm::cross(points[quad[2]] - points[quad[0]], points[quad[3]] - points[quad[1]]);
}

bool creased(const CrossEdge& edge, const FineMesh& fine, const std::vector<glm::dvec3>& points) {
  const glm::dvec3 a = normal(fine.quads[edge.face_before], points);
  const glm::dvec3 b = normal(fine.quads[edge.face_after], points);
  return glm::dot(a, b) < kCrease * glm::length(a) * glm::length(b);
}

/// The point between two others that divides their distance in the ratio of a third point's
/// distances.
glm::dvec3 between(const glm::dvec3& before, const glm::dvec3& p, const glm::dvec3& after) {
  const double low = glm::distance(before, p), high = glm::distance(p, after);
  const double sum = low + high;
  return sum > 0.0 ? (before * high + after * low) / sum : p;
}

}  // namespace

void soften_creases(const FineMesh& fine, std::span<const FaceOrigin> origins,
                    const std::vector<int32_t>& chains, std::span<const double> farthest,
                    std::vector<glm::dvec3>& points) {
  std::vector<CrossEdge> edges = cross_edges(fine, origins, chains, farthest);
  const std::vector<glm::dvec3> first(points);
  // Per vertex: the last round in which it moved. Edges whose faces stayed need no second look.
  std::vector<int8_t> moved(points.size(), -1);
  const auto has_moved = [&](const CrossEdge& edge, int round) {
    const auto any = [&](const std::array<int32_t, 2>& two) {
      return moved[two[0]] == round || moved[two[1]] == round;
    };
    return any(edge.ends) || any(edge.before) || any(edge.after);
  };
  // Targets of an end of several creases, and their number.
  std::vector<std::pair<int32_t, glm::dvec3>> wanted;
  for (int round = 0; round < kCreaseRounds; ++round) {
    wanted.clear();
    for (CrossEdge& edge : edges) {
      if (has_moved(edge, round - 1)) edge.is_creased = creased(edge, fine, points);
      if (!edge.is_creased) continue;
      for (int k = 0; k < 2; ++k) {
        const int32_t v = edge.ends[k];
        if (farthest[v] <= 0.0) continue;
        wanted.emplace_back(
            v, between(points[edge.before[k]], points[v], points[edge.after[k]]) - points[v]);
      }
    }
    if (wanted.empty()) return;
    std::stable_sort(wanted.begin(), wanted.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    for (size_t i = 0; i < wanted.size();) {
      const int32_t v = wanted[i].first;
      glm::dvec3 sum(0.0);
      double count = 0.0;
      for (; i < wanted.size() && wanted[i].first == v; ++i, count += 1.0) sum += wanted[i].second;
      const glm::dvec3 offset = points[v] + sum * (kStep / count) - first[v];
      const double length = glm::length(offset);
      points[v] = first[v] + (length > farthest[v] ? offset * (farthest[v] / length) : offset);
      moved[v] = static_cast<int8_t>(round);
    }
  }
}

}  // namespace snowbough::tree
