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

/// A point of the surface, given in the map's texels (not in 0..1).
struct SurfacePoint {
  int32_t chart = 0;
  glm::dvec2 at{0.0};
};

/// Walks straight over the surface of a map, from chart to chart across the seams.
///
/// Each seam carries an affine map from one side's layout to the other's: the two triangles are
/// laid flat into one plane, in metres, along their common edge, so that along the edge maps to
/// along the edge, the distance from it is kept in metres, and mirrored charts come out mirrored.
class SeamWalk {
 public:
  /// `positions`: vertices in metres, in the pose that the layout was made for. All are kept by
  /// reference only while the constructor runs.
  SeamWalk(const MapTopology& topology, const Charts& charts,
           const std::vector<glm::vec3>& positions);

  /// Moves `point` straight to `target` (in the layout of the chart it starts in); at each seam
  /// that lies between, point, target and `direction` change over to the other chart's layout.
  /// Returns false where the surface ends before.
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
    /// The chart beyond (-1: the surface ends), and where a point x of this chart lies there:
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
  /// The row or column of cells of a coordinate in texels.
  int32_t cell(double x) const {
    return std::clamp(static_cast<int32_t>(x * cells_per_texel_), 0, cells_ - 1);
  }
  void sort_into_cells(int32_t resolution);
  /// The first side of `chart` that the way from `from` to `to` crosses outwards; `part` of the
  /// way.
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
