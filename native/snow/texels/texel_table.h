#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <vector>

namespace snowbough::snow {

/// A receiver's fixed topology, as in add_object.
struct MapTopology {
  /// T triangles, three vertex indices each.
  std::vector<int32_t> triangles;
  /// T x 3 texture coordinates, one per triangle corner; (0, 0) is the map's lower left corner.
  std::vector<glm::vec2> corner_uv;
  int32_t vertex_count = 0;
  /// The map is resolution x resolution texels; row 0 = v 0.
  int32_t resolution = 1024;
};

/// The surface that each texel of a map carries, found once by exact clipping of every triangle
/// against every texel: sampling texel centres would lose charts 1.5 texels wide.
///
/// A texel belongs to the chart that covers most of it. Fragments of a chart in another chart's
/// texels are reassigned to the chart's nearest own texel, so that for every triangle the shares of
/// its fragments sum to 1 and the texels' areas sum to the mesh's area under every deformation.
struct TexelTable {
  int32_t resolution = 0;

  /// Per owned texel, ascending: linear index row * resolution + column.
  std::vector<int32_t> texel;
  /// Per owned texel: the triangle and the barycentric weights of its second and third corner at
  /// the texel's sample point: the centre if the chart covers it, otherwise the centroid of the
  /// covered part (of the largest fragment if that centroid lies outside the surface). World
  /// position and normal follow from the current vertices.
  std::vector<int32_t> triangle;
  std::vector<glm::vec2> barycentric;
  /// Per owned texel: its chart's number.
  std::vector<int32_t> chart;
  /// Per owned texel: the part of its square that its chart covers, 0 to 1.
  std::vector<float> coverage;

  /// Fragments of owned texel i: [fragment_begin[i], fragment_begin[i + 1]).
  std::vector<int32_t> fragment_begin;
  /// The fragment's triangle and its share of that triangle's area (0 to 1): the covered area in m2
  /// is the sum of share * current area of the triangle.
  std::vector<int32_t> fragment_triangle;
  std::vector<float> fragment_share;
  /// The fragment's centroid in its triangle: weights of the second and third corner.
  std::vector<glm::vec2> fragment_barycentric;

  int32_t chart_count = 0;
  /// Number of triangles without area in UV space (less than a millionth of a texel high): they
  /// hold no snow and have no fragments. Reported.
  int32_t degenerate_triangles = 0;
  /// Number of charts without a texel, because each texel under them is the only one of another
  /// chart: their area is reassigned to the texel's owner, which receives their snow. Reported.
  int32_t unmapped_charts = 0;
  /// Fraction of the covered texel area that more than one triangle covers (overlapping layout),
  /// measured on 8 x 8 sub-samples per texel.
  float overlap = 0.0f;
};

/// Builds the table. O(covered texels + triangles). A chart too small to own any texel takes the
/// one it covers most, if that texel's owner has another. `threads` share the work on large maps (0
/// = one per core); they do not change the result.
/// @throws std::invalid_argument for an index out of range, wrong array sizes, a resolution outside
/// [64, 8192], or coordinates outside [0, 1] by more than 1e-4 (with their number).
TexelTable build_texel_table(const MapTopology& topology, int32_t threads = 0);

}  // namespace snowbough::snow
