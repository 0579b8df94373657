#include "snow/texels/open_sheets.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <utility>

#include "snow/texels/sheets.h"

namespace snowbough::snow {
namespace {

/// Per vertex: the first vertex at its position.
std::vector<int32_t> places_of(const std::vector<int32_t>& triangles,
                               const std::vector<glm::vec3>& positions) {
  glm::dvec3 low(1e300);
  glm::dvec3 high(-1e300);
  for (const int32_t index : triangles) {
    low = glm::min(low, glm::dvec3(positions[static_cast<size_t>(index)]));
    high = glm::max(high, glm::dvec3(positions[static_cast<size_t>(index)]));
  }
  const double size = std::max({high.x - low.x, high.y - low.y, high.z - low.z, 1e-30});
  // 21 bits per axis, so that a number sorts fast.
  std::vector<std::pair<uint64_t, int32_t>> order;
  order.reserve(positions.size());
  for (size_t i = 0; i < positions.size(); ++i) {
    const glm::dvec3 cells = (glm::dvec3(positions[i]) - low) * (1e6 / size);
    uint64_t key = 0;
    // Cell borders avoid round numbers; unused vertices may be anywhere.
    for (int axis = 0; axis < 3; ++axis) {
      key = key << 21 | static_cast<uint64_t>(std::clamp(cells[axis] + 0.3719, 0.0, 2e6));
    }
    order.emplace_back(key, static_cast<int32_t>(i));
  }
  std::sort(order.begin(), order.end());
  std::vector<int32_t> place(positions.size());
  for (size_t i = 0; i < order.size(); ++i) {
    const bool is_new = i == 0 || order[i].first != order[i - 1].first;
    place[static_cast<size_t>(order[i].second)] =
        is_new ? order[i].second : place[static_cast<size_t>(order[i - 1].second)];
  }
  return place;
}

/// An edge between two positions, the lower one in the upper half, and a triangle with it.
using Edge = std::pair<uint64_t, int32_t>;

/// Sorted edges, without degenerate ones.
std::vector<Edge> edges_of(const std::vector<int32_t>& triangles) {
  std::vector<Edge> edges;
  edges.reserve(triangles.size());
  for (size_t corner = 0; corner < triangles.size(); ++corner) {
    const size_t first = corner / 3 * 3;
    const auto [low, high] = std::minmax(triangles[corner], triangles[first + (corner + 1) % 3]);
    if (low == high) continue;
    edges.emplace_back(static_cast<uint64_t>(low) << 32 | static_cast<uint32_t>(high),
                       static_cast<int32_t>(corner / 3));
  }
  std::sort(edges.begin(), edges.end());
  return edges;
}

}  // namespace

std::vector<uint8_t> find_open_sheets(const std::vector<int32_t>& triangles,
                                      const std::vector<glm::vec3>& positions) {
  const std::vector<int32_t> place = places_of(triangles, positions);
  std::vector<int32_t> merged(triangles.size());
  std::transform(triangles.begin(), triangles.end(), merged.begin(),
                 [&](int32_t index) { return place[static_cast<size_t>(index)]; });
  const Sheets sheets = find_sheets(merged, static_cast<int32_t>(positions.size()));
  const auto point = [&](int32_t index) {
    return glm::dvec3(positions[static_cast<size_t>(index)]);
  };
  std::vector<double> rim(static_cast<size_t>(sheets.count), 0.0);
  std::vector<double> area(static_cast<size_t>(sheets.count), 0.0);
  const auto sheet_of = [&](size_t triangle) {
    return static_cast<size_t>(sheets.sheet[triangle]);
  };
  for (size_t t = 0; t < sheets.sheet.size(); ++t) {
    const glm::dvec3 a = point(triangles[3 * t]);
    area[sheet_of(t)] += 0.5 * glm::length(glm::cross(point(triangles[3 * t + 1]) - a,
                                                      point(triangles[3 * t + 2]) - a));
  }
  const std::vector<Edge> edges = edges_of(merged);
  for (size_t i = 0; i < edges.size(); ++i) {
    const auto& [edge, triangle] = edges[i];
    const bool is_shared = (i > 0 && edges[i - 1].first == edge) ||
                           (i + 1 < edges.size() && edges[i + 1].first == edge);
    if (is_shared) continue;
    rim[sheet_of(static_cast<size_t>(triangle))] += glm::length(
        point(static_cast<int32_t>(edge & 0xFFFFFFFFu)) - point(static_cast<int32_t>(edge >> 32)));
  }
  std::vector<uint8_t> open(sheets.sheet.size());
  for (size_t t = 0; t < open.size(); ++t) {
    const double length = rim[sheet_of(t)];
    open[t] = length * length > kLargestOpening * area[sheet_of(t)] ? 1 : 0;
  }
  return open;
}

}  // namespace snowbough::snow
