#pragma once

#include <algorithm>
#include <cstdint>
#include <glm/mat2x2.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "snow/texels/charts.h"
#include "snow/texels/texel_table.h"

namespace snowbough::snow {

/// A point of the surface, in texels of the map (not 0..1).
struct SurfacePoint {
  int32_t chart = 0;
  glm::dvec2 at{0.0};
};

/// Walks straight across the surface of a map, from chart to chart over the seams.
///
/// Each seam has an affine map from one side's layout to the other's: the two triangles are
/// unfolded into one plane, in metres, along their common edge. The direction along the edge and
/// the distance from it in metres are kept; mirrored charts stay mirrored.
class SeamWalk {
 public:
  /// `positions`: vertices in metres, in the pose for which the layout was made. The constructor
  /// keeps no references.
  SeamWalk(const MapTopology& topology, const Charts& charts,
           const std::vector<glm::vec3>& positions);

  /// Moves `point` straight to `target` (in the layout of its starting chart); at each seam on the
  /// way, point, target and `direction` change to the other chart's layout. Returns false if the
  /// surface ends first.
  bool go(SurfacePoint& point, const glm::dvec2& target, glm::dvec2& direction) const;

  /// Whether the straight line between two points of a chart leaves the chart.
  bool leaves_chart(int32_t chart, const glm::dvec2& from, const glm::dvec2& to) const;

 private:
  /// One side of a chart's border.
  struct Side {
    int32_t chart;
    glm::dvec2 begin;
    glm::dvec2 along;
    /// Perpendicular to `along`, away from the chart; not of unit length.
    glm::dvec2 outward;
    /// The chart beyond (-1: the surface ends), and the mapping of a point x of this chart to it:
    /// other_begin + change * (x - begin).
    int32_t other = -1;
    glm::dvec2 other_begin{0.0};
    glm::dmat2 change{1.0};
  };

  /// A side in a cell.
  struct Entry {
    int32_t chart;
    int32_t side;
  };

  void add_side(const Side& side);
  /// The row or column of cells of a coordinate in texels. Clamped before it is an integer: beside
  /// a sliver, a step of a texel may lead anywhere, or to NaN, which becomes 0.
  int32_t cell(double x) const {
    const double last = cells_ - 1;
    return static_cast<int32_t>(std::min(std::max(0.0, x * cells_per_texel_), last));
  }
  void sort_into_cells(int32_t resolution);
  /// The first side of `chart` that the line from `from` to `to` crosses outwards; `part`: where,
  /// as a fraction of the line.
  const Side* first_crossing(int32_t chart, const glm::dvec2& from, const glm::dvec2& to,
                             double& part) const;

  std::vector<Side> sides_;
  /// A grid of square cells, some texels wide, row by row, and the sides in each.
  int32_t cells_ = 1;
  double cells_per_texel_ = 1.0;
  std::vector<int32_t> cell_begin_;
  std::vector<Entry> entries_;
};

}  // namespace snowbough::snow
