#include "snow/seams/seam_walk.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "base/group_by_key.h"

namespace snowbough::snow {
namespace {

/// More crossings on one walk of a few texels mean charts far smaller than a texel.
constexpr int kMaxCrossings = 16;
/// Cells of four texels hold few sides, and their table fits the cache.
constexpr int32_t kCellTexels = 4;
constexpr int32_t kMaxCells = 1024;

/// A triangle at an edge: the edge's ends and the third corner, on the map and in space.
struct Flank {
  glm::dvec2 uv[3];
  glm::dvec3 position[3];
};

Flank flank_of(const MapTopology& topology, const std::vector<glm::vec3>& positions,
               TriangleEdge side, bool swap_ends) {
  Flank flank;
  for (int32_t k = 0; k < 3; ++k) {
    int32_t corner = (side.edge + k) % 3;
    if (swap_ends && k < 2) corner = (side.edge + 1 - k) % 3;
    const size_t index = 3 * static_cast<size_t>(side.triangle) + static_cast<size_t>(corner);
    flank.uv[k] = glm::dvec2(topology.corner_uv[index]) * static_cast<double>(topology.resolution);
    flank.position[k] = glm::dvec3(positions[topology.triangles[index]]);
  }
  return flank;
}

/// Linear map from texels to metres in the triangle's plane: x along the edge, y from the edge
/// towards the third corner. Singular for a triangle without area in space.
glm::dmat2 flatten(const Flank& flank) {
  const glm::dvec3 edge = flank.position[1] - flank.position[0];
  const glm::dvec3 third = flank.position[2] - flank.position[0];
  const double length = glm::length(edge);
  if (length == 0.0) return glm::dmat2(0.0);
  const double along = glm::dot(third, edge) / length;
  const double across = glm::length(glm::cross(edge, third)) / length;
  const glm::dmat2 layout(flank.uv[1] - flank.uv[0], flank.uv[2] - flank.uv[0]);
  if (glm::determinant(layout) == 0.0) return glm::dmat2(0.0);
  return glm::dmat2(glm::dvec2(length, 0.0), glm::dvec2(along, across)) * glm::inverse(layout);
}

/// Fallback without a usable shape in space: edge to edge, with the same scale across.
glm::dmat2 similarity(const Flank& from, const Flank& to) {
  const auto frame = [](const Flank& f, double inside) {
    const glm::dvec2 along = f.uv[1] - f.uv[0];
    glm::dvec2 across(-along.y, along.x);
    if (glm::dot(across, f.uv[2] - f.uv[0]) * inside < 0.0) across = -across;
    return glm::dmat2(along, across);
  };
  const glm::dmat2 from_frame = frame(from, 1.0);
  if (glm::determinant(from_frame) == 0.0) return glm::dmat2(0.0);
  return frame(to, -1.0) * glm::inverse(from_frame);
}

glm::dmat2 layout_change(const Flank& from, const Flank& to) {
  const glm::dmat2 from_metres = flatten(from);
  const glm::dmat2 to_metres = flatten(to);
  // The other triangle lies on the other side of the edge.
  const glm::dmat2 mirror(1.0, 0.0, 0.0, -1.0);
  const double size = std::abs(glm::determinant(to_metres));
  const double limit = 1e-12 * glm::dot(to_metres[0], to_metres[0]);
  if (std::abs(glm::determinant(from_metres)) == 0.0 || size <= limit) return similarity(from, to);
  return glm::inverse(mirror * to_metres) * from_metres;
}

glm::dvec2 outward_of(const Flank& flank) {
  const glm::dvec2 along = flank.uv[1] - flank.uv[0];
  const glm::dvec2 across(along.y, -along.x);
  return glm::dot(across, flank.uv[2] - flank.uv[0]) > 0.0 ? -across : across;
}

}  // namespace

SeamWalk::SeamWalk(const MapTopology& topology, const Charts& charts,
                   const std::vector<glm::vec3>& positions) {
  for (const Seam& seam : charts.seams) {
    const Flank a = flank_of(topology, positions, seam.a, false);
    const Flank b = flank_of(topology, positions, seam.b, !seam.same_direction);
    const int32_t chart_a = charts.chart[seam.a.triangle];
    const int32_t chart_b = charts.chart[seam.b.triangle];
    add_side({chart_a, a.uv[0], a.uv[1] - a.uv[0], outward_of(a), chart_b, b.uv[0],
              layout_change(a, b)});
    add_side({chart_b, b.uv[0], b.uv[1] - b.uv[0], outward_of(b), chart_a, a.uv[0],
              layout_change(b, a)});
  }
  for (const TriangleEdge& edge : charts.open_edges) {
    const Flank a = flank_of(topology, positions, edge, false);
    add_side({charts.chart[edge.triangle], a.uv[0], a.uv[1] - a.uv[0], outward_of(a), -1,
              glm::dvec2(0.0), glm::dmat2(1.0)});
  }
  sort_into_cells(topology.resolution);
}

void SeamWalk::add_side(const Side& side) {
  // A side without length on the map cannot be crossed.
  if (side.along != glm::dvec2(0.0)) sides_.push_back(side);
}

void SeamWalk::sort_into_cells(int32_t resolution) {
  cells_ = std::clamp(resolution / kCellTexels, 1, kMaxCells);
  cells_per_texel_ = static_cast<double>(cells_) / resolution;
  const auto for_each_cell = [&](const Side& side, const auto& visit) {
    const glm::dvec2 end = side.begin + side.along;
    const double low = std::min(side.begin.y, end.y);
    const double high = std::max(side.begin.y, end.y);
    for (int32_t row = cell(low); row <= cell(high); ++row) {
      // The part of the side in this row of cells, widened slightly against rounding.
      double from = side.begin.x;
      double to = end.x;
      if (high > low) {
        const double bottom = std::clamp(row / cells_per_texel_, low, high);
        const double top = std::clamp((row + 1) / cells_per_texel_, low, high);
        from = side.begin.x + side.along.x * ((bottom - side.begin.y) / side.along.y);
        to = side.begin.x + side.along.x * ((top - side.begin.y) / side.along.y);
      }
      const int32_t last = cell(std::max(from, to) + 1e-6);
      for (int32_t column = cell(std::min(from, to) - 1e-6); column <= last; ++column) {
        visit(row * cells_ + column);
      }
    }
  };
  const auto for_entries = [&](const auto& visit) {
    for (size_t s = 0; s < sides_.size(); ++s) {
      const Entry entry{sides_[s].chart, static_cast<int32_t>(s)};
      for_each_cell(sides_[s], [&](int32_t c) { visit(c, entry); });
    }
  };
  base::group_by_key(static_cast<size_t>(cells_) * cells_, for_entries, cell_begin_, entries_);
}

const SeamWalk::Side* SeamWalk::first_crossing(int32_t chart, const glm::dvec2& from,
                                               const glm::dvec2& to, double& part) const {
  constexpr double kTolerance = 1e-7;
  const Side* first = nullptr;
  part = 1.0;
  const int32_t last_row = cell(std::max(from.y, to.y) + kTolerance);
  const int32_t first_column = cell(std::min(from.x, to.x) - kTolerance);
  const int32_t last_column = cell(std::max(from.x, to.x) + kTolerance);
  for (int32_t row = cell(std::min(from.y, to.y) - kTolerance); row <= last_row; ++row) {
    // The entries of adjacent cells are consecutive.
    const int32_t* begin = &cell_begin_[static_cast<size_t>(row) * cells_];
    for (int32_t i = begin[first_column]; i < begin[last_column + 1]; ++i) {
      if (entries_[i].chart != chart) continue;
      const Side& side = sides_[entries_[i].side];
      const glm::dvec2 way = to - from;
      // Only sides crossed outwards count, so that a walk that has just entered is not sent back.
      const double speed = glm::dot(way, side.outward);
      if (speed <= 0.0) continue;
      const double at = glm::dot(side.begin - from, side.outward) / speed;
      if (at < -kTolerance || at > part || (at == part && first != nullptr)) continue;
      const glm::dvec2 hit = from + way * at - side.begin;
      const double along = glm::dot(hit, side.along) / glm::dot(side.along, side.along);
      if (along < -kTolerance || along > 1.0 + kTolerance) continue;
      part = at;
      first = &side;
    }
  }
  return first;
}

bool SeamWalk::go(SurfacePoint& point, const glm::dvec2& target, glm::dvec2& direction) const {
  glm::dvec2 to = target;
  for (int crossing = 0; crossing < kMaxCrossings; ++crossing) {
    double part = 1.0;
    const Side* side = first_crossing(point.chart, point.at, to, part);
    if (side == nullptr) {
      point.at = to;
      return true;
    }
    if (side->other < 0) return false;
    const glm::dvec2 hit = point.at + (to - point.at) * std::max(part, 0.0);
    point.chart = side->other;
    point.at = side->other_begin + side->change * (hit - side->begin);
    to = side->other_begin + side->change * (to - side->begin);
    direction = side->change * direction;
    // A nearly degenerate triangle beyond would send the walk far across the map.
    const glm::dvec2 rest = to - point.at;
    if (!(glm::dot(rest, rest) < 64.0 * 64.0)) return false;
  }
  return false;
}

bool SeamWalk::leaves_chart(int32_t chart, const glm::dvec2& from, const glm::dvec2& to) const {
  double part = 1.0;
  return first_crossing(chart, from, to, part) != nullptr;
}

}  // namespace snowbough::snow
