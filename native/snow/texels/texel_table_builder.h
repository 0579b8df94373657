#pragma once

#include <cstdint>
#include <vector>

#include "snow/texels/charts.h"
#include "snow/texels/texel_table.h"
#include "snow/texels/uv_clip.h"

namespace snowbough::snow {

/// An unfinished texel table, passed between the steps of build_texel_table. Until
/// shares_from_areas, `table.fragment_share` holds areas in texels.
struct TexelTableBuilder {
  explicit TexelTableBuilder(const MapTopology& given);

  int32_t chart_of(int32_t triangle) const { return charts.chart[triangle]; }
  /// Index of a texel among the owned ones; the texel must be owned.
  size_t owned_index(int32_t texel) const;

  const MapTopology& topology;
  Charts charts;
  TexelTable table;
  /// Per triangle: total area of its fragments in texels.
  std::vector<double> triangle_area;
  /// Per chart: number of texels it owns.
  std::vector<int32_t> own_texels;
  /// Fragments in texels of other charts.
  std::vector<Fragment> displaced;
};

/// A triangle's UVs in texels, inside the map.
UvTriangle texel_triangle(const MapTopology& topology, int32_t triangle);

/// First step (cut.cpp): cuts every triangle against every texel. A texel goes to the chart that
/// covers most of it (on a tie, the lower number); fragments of other charts are displaced. Counts
/// degenerate triangles and overlap. The number of threads does not change the result.
void cut_map(TexelTableBuilder& builder, int32_t threads);

/// The surface that a texel carries; see TexelTable.
struct TexelSample {
  int32_t triangle;
  glm::vec2 barycentric;
  float coverage;
};

/// Finds texels' sample points (sample.cpp).
class TexelSampler {
 public:
  /// `topology` is kept by reference.
  explicit TexelSampler(const MapTopology& topology) : topology_(topology) {}

  /// Sample of a texel that lies wholly in one triangle; `centre` in texels.
  TexelSample whole(int32_t triangle, glm::dvec2 centre);
  /// Sample of a texel from its chart's fragments: all in one texel, at least one, ascending.
  TexelSample of(const std::vector<Fragment>& own);
  /// Weights of the second and third corner at a fragment's centroid.
  glm::vec2 centroid(const Fragment& fragment);

 private:
  /// A triangle on the map, prepared for barycentric weights.
  struct Frame {
    int32_t triangle = -1;
    glm::dvec2 corner;
    glm::dvec2 side_b;
    glm::dvec2 side_c;
    double area;
  };

  glm::dvec2 barycentric_at(int32_t triangle, glm::dvec2 point);
  void prepare(int32_t triangle);
  bool find_triangle(const std::vector<Fragment>& own, glm::dvec2 point, TexelSample& sample);

  const MapTopology& topology_;
  /// Frame of the last triangle: neighbouring texels often share it.
  Frame frame_;
};

/// Second step (small_charts.cpp): a chart without texels takes the one that it covers most, if
/// that texel's owner has another; other such charts count as unmapped.
void assign_texels_to_small_charts(TexelTableBuilder& builder);

/// Third step (reassign.cpp): displaced fragments go to their own chart's nearest texel; fragments
/// of unmapped charts stay.
void reassign_displaced_fragments(TexelTableBuilder& builder);

}  // namespace snowbough::snow
