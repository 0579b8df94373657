#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

namespace snowbough::tree {

/// A surface with one UV coordinate per corner: `sides` corners per face (3 or 4), flat.
struct UvSurface {
  int sides = 4;
  std::vector<glm::vec3> vertices;
  std::vector<int32_t> corner_vertex;
  std::vector<glm::vec2> corner_uv;
};

/// Quality of a unique UV layout at a map resolution. Charts are groups of faces that share an edge
/// of the surface and its coordinates at both ends.
struct UvLayoutMeasure {
  int64_t chart_count = 0;
  /// Covered area over the map's area.
  double fill = 0.0;
  /// Texels touched by two charts, or covered more than once by one.
  int64_t overlap_texels = 0;
  /// Texels with another chart in one of their eight neighbours: no free texel between the charts.
  int64_t narrow_gutter_texels = 0;
  /// Texels of charts wider than four texels with another chart within two texels.
  int64_t narrow_wide_gutter_texels = 0;
  /// Faces that extend beyond the unit square.
  int64_t outside_faces = 0;
  /// Smallest signed area of a face in texels; not positive if a face is folded or mirrored.
  double min_face_area = 0.0;
  /// Smallest side of a chart's bounding box, and smallest ratio of area to longest side, in
  /// texels.
  double min_chart_extent = 0.0;
  double min_chart_mean_width = 0.0;
  /// Percentiles of texels per m2, weighted by the faces' areas in m2.
  double density_p5 = 0.0;
  double density_p50 = 0.0;
  double density_p95 = 0.0;
};

/// Rasterises by exact clipping of every face against every texel. A chart touches a texel if it
/// covers more than 5e-4 of it (on large maps float32 rounding is that large).
/// @throws std::invalid_argument for inconsistent array sizes, indices out of range or a resolution
/// outside 1 to 16384.
UvLayoutMeasure measure_uv_layout(const UvSurface& surface, int resolution);

}  // namespace snowbough::tree
