#pragma once

#include <cstdint>
#include <vector>

#include "snow/texels/charts.h"
#include "snow/texels/texel_table.h"
#include "snow/texels/uv_clip.h"

namespace snowbough::snow {

/// A texel table in the making, handed from step to step of build_texel_table. Until
/// shares_from_areas, `table.fragment_share` holds areas in texels.
struct TexelTableBuilder {
  explicit TexelTableBuilder(const MapTopology& given);

  int32_t chart_of(int32_t triangle) const { return charts.chart[triangle]; }
  /// Position of a texel among the owned ones. It must be there.
  size_t owned_index(int32_t texel) const;

  const MapTopology& topology;
  Charts charts;
  TexelTable table;
  /// Per triangle: the area of all its fragments in texels.
  std::vector<double> triangle_area;
  /// Per chart: how many texels it owns.
  std::vector<int32_t> own_texels;
  /// Fragments that lie in texels of other charts.
  std::vector<Fragment> displaced;
};

/// A triangle's UVs in texels, inside the map.
UvTriangle texel_triangle(const MapTopology& topology, int32_t triangle);

/// First step (cut.cpp): cuts every triangle against every texel; a texel goes to the chart
/// that covers most of it (of equals the lower number), the others' fragments are displaced.
/// Counts degenerate triangles and overlap. The result does not depend on the number of threads.
void cut_map(TexelTableBuilder& builder, int32_t threads);

/// Which surface a texel carries; as in TexelTable.
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

  /// Of a texel that lies wholly in one triangle; `centre` in texels.
  TexelSample whole(int32_t triangle, glm::dvec2 centre);
  /// Of a texel with its chart's fragments: all in one texel, at least one, ascending.
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
  /// Of the triangle asked for last: neighbours often have the same.
  Frame frame_;
};

/// Second step (small_charts.cpp): charts that own nothing take the texel they cover most, where
/// its owner can spare it; the others are counted as unmapped.
void assign_texels_to_small_charts(TexelTableBuilder& builder);

/// Third step (reassign.cpp): displaced fragments go to their own chart's nearest texel; an
/// unmapped chart's stay where they are.
void reassign_displaced_fragments(TexelTableBuilder& builder);

}  // namespace snowbough::snow
