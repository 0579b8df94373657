#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <vector>

namespace snowbough::snow {

using UvTriangle = std::array<glm::dvec2, 3>;

/// A convex polygon: a triangle cut by a square has at most seven corners.
struct ClipPolygon {
  std::array<glm::dvec2, 8> points;
  int32_t count = 0;
};

/// The part of `polygon` with lower <= point[axis] <= upper.
ClipPolygon clip_to_slab(const ClipPolygon& polygon, int axis, double lower, double upper);

/// Area and centroid; centroid is the mean of the corners where the area is 0.
struct AreaCentroid {
  double area = 0.0;
  glm::dvec2 centroid{0.0};
};
AreaCentroid area_and_centroid(const ClipPolygon& polygon);

/// A triangle's edges, prepared for sample_mask.
struct SampleEdges {
  struct Edge {
    glm::dvec2 low;
    double high_y;
    /// dx / dy.
    double slope;
  };
  explicit SampleEdges(const UvTriangle& triangle);
  std::array<Edge, 3> edges;
};

/// Which of a texel's 8 x 8 sub-samples the triangle holds: bit 8 * row + column. Half-open, so
/// that of two triangles that share an edge exactly one holds a sample on it. `corner` is the
/// texel's lower left corner; a texel is 1 x 1.
uint64_t sample_mask(const SampleEdges& triangle, glm::dvec2 corner);

/// The part of one triangle that lies in one texel; areas and positions in texels.
struct Fragment {
  int32_t texel;
  int32_t triangle;
  double area;
  glm::dvec2 centroid;
  /// Its part of the texel's sub-samples, as sample_mask gives them.
  uint64_t samples;
};

/// Cuts the rows [row_begin, row_end) of `triangle` (number `index`) of a resolution x resolution
/// map into fragments, appended to `fragments`, rows ascending, columns ascending.
void cut_triangle(const UvTriangle& triangle, int32_t index, int32_t resolution, int32_t row_begin,
                  int32_t row_end, std::vector<Fragment>& fragments);

}  // namespace snowbough::snow
