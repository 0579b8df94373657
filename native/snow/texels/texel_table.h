#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <vector>

namespace snowbough::snow {

/// A receiver's fixed topology, as add_object gets it.
struct MapTopology {
  /// T triangles, three vertex indices each.
  std::vector<int32_t> triangles;
  /// T x 3 texture coordinates, one a triangle corner; (0, 0) is the map's lower left corner.
  std::vector<glm::vec2> corner_uv;
  int32_t vertex_count = 0;
  /// The map is resolution x resolution texels; row 0 = v 0.
  int32_t resolution = 1024;
};

/// Which surface each texel of a map carries, found once by exact clipping of every triangle
/// against every texel: sampling texel centres would lose charts 1.5 texels wide.
///
/// A texel belongs to the chart that covers most of it. Fragments of a chart in texels that belong
/// to another chart are reassigned to the chart's nearest own texel, so that for every triangle the
/// shares of its fragments sum to 1 and the texels' areas sum to the mesh's area, whatever the
/// current deformation.
struct TexelTable {
  int32_t resolution = 0;

  /// Per owned texel, ascending: linear index row * resolution + column.
  std::vector<int32_t> texel;
  /// Per owned texel: the triangle and the barycentric weights of its second and third corner at
  /// the texel's sample point: its centre where the chart covers it, else the centroid of the part
  /// that is covered (of the largest fragment's part, where the whole part's centroid lies outside
  /// the surface). World position and normal follow from the current vertices.
  std::vector<int32_t> triangle;
  std::vector<glm::vec2> barycentric;
  /// Per owned texel: its chart's number.
  std::vector<int32_t> chart;
  /// Per owned texel: the part of its square that its chart covers, 0 to 1.
  std::vector<float> coverage;

  /// Fragments of owned texel i: [fragment_begin[i], fragment_begin[i + 1]).
  std::vector<int32_t> fragment_begin;
  /// The triangle, and which share of that triangle's area (0 to 1) the fragment holds: the covered
  /// area in m2 is the sum of share * current area of the triangle.
  std::vector<int32_t> fragment_triangle;
  std::vector<float> fragment_share;
  /// Where the fragment's centroid lies in its triangle: weights of the second and third corner.
  std::vector<glm::vec2> fragment_barycentric;

  int32_t chart_count = 0;
  /// Number of triangles without area in UV space (less than a millionth of a texel high): they can
  /// hold no snow, have no fragments and are reported.
  int32_t degenerate_triangles = 0;
  /// Number of charts that got no texel because every texel under them is some other chart's only
  /// one: their area is reassigned to the texel's owner and their snow lands there. Reported.
  int32_t unmapped_charts = 0;
  /// Share of the covered texel area that more than one triangle covers (overlapping layout),
  /// measured on 8 x 8 sub-samples a texel.
  float overlap = 0.0f;
};

/// Builds the table. O(covered texels + triangles). A chart too small to own any of its texels
/// takes the one it covers most, if the owner there has another. `threads` share the work where the
/// map is large (0 = one a core); the result does not depend on them.
/// @throws std::invalid_argument for an index out of range, wrong array sizes, a resolution outside
/// [64, 8192], or coordinates outside [0, 1] by more than 1e-4 (the message says how many).
TexelTable build_texel_table(const MapTopology& topology, int32_t threads = 0);

}  // namespace snowbough::snow
