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

/// Area and centroid; the mean of the corners if the area is 0.
struct AreaCentroid {
  double area = 0.0;
  glm::dvec2 centroid{0.0};
};
AreaCentroid area_and_centroid(const ClipPolygon& polygon);

/// A triangle's edges, prepared for SampleRow.
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

/// Where a triangle begins and ends on the eight sub-sample lines of a row of texels.
class SampleRow {
 public:
  SampleRow(const SampleEdges& triangle, int32_t row);

  /// The texel's 8 x 8 sub-samples inside the triangle: bit 8 * row + column. Half-open, so that
  /// exactly one of two triangles that share an edge holds a sample on it.
  uint64_t inside(int32_t column) const;

 private:
  std::array<double, 8> left_;
  std::array<double, 8> right_;
};

/// The part of one triangle that lies in one texel; areas and positions in texels.
struct Fragment {
  int32_t texel;
  int32_t triangle;
  double area;
  glm::dvec2 centroid;
  /// The texel's sub-samples inside it, as from SampleRow.
  uint64_t samples;
};

/// In texels.
inline glm::dvec2 texel_centre(int32_t texel, int32_t resolution) {
  return {texel % resolution + 0.5, texel / resolution + 0.5};
}

/// The fragment of a triangle that covers a whole texel.
Fragment whole_fragment(int32_t texel, int32_t triangle, int32_t resolution);

/// Consecutive texels that lie wholly in one triangle.
struct WholeRun {
  int32_t first_texel;
  int32_t count;
  int32_t triangle;
};

/// Texels that triangles cover wholly, and fragments of the others.
struct TriangleCuts {
  std::vector<WholeRun> whole;
  std::vector<Fragment> parts;

  void clear() {
    whole.clear();
    parts.clear();
  }
};

/// Cuts the rows [row_begin, row_end) of `triangle` (number `index`) of a resolution x resolution
/// map, appended to `cuts`, rows ascending, columns ascending. Returns the total area in texels,
/// summed in this order.
double cut_triangle(const UvTriangle& triangle, int32_t index, int32_t resolution,
                    int32_t row_begin, int32_t row_end, TriangleCuts& cuts);

}  // namespace snowbough::snow
