// The steps of the texel table one by one: cutting, texels for small charts, displaced fragments.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

#include "snow/texels/texel_table_builder.h"

namespace snowbough::snow {
namespace {

using ::testing::ElementsAre;

constexpr int32_t kResolution = 64;

/// A layout of rectangles, each a chart of two triangles, in texels of a map of 64.
struct Layout {
  MapTopology topology;

  Layout() { topology.resolution = kResolution; }

  Layout& rectangle(double left, double bottom, double right, double top) {
    const int32_t first = topology.vertex_count;
    for (const int32_t corner : {0, 1, 2, 0, 2, 3}) topology.triangles.push_back(first + corner);
    const glm::vec2 a(left / kResolution, bottom / kResolution);
    const glm::vec2 c(right / kResolution, top / kResolution);
    const glm::vec2 b(c.x, a.y);
    const glm::vec2 d(a.x, c.y);
    topology.corner_uv.insert(topology.corner_uv.end(), {a, b, c, a, c, d});
    topology.vertex_count += 4;
    return *this;
  }

  TexelTableBuilder cut() const {
    TexelTableBuilder builder(topology);
    cut_map(builder, 1);
    return builder;
  }
};

/// Texels' area that a chart's fragments hold in an owned texel.
double area_in(const TexelTableBuilder& builder, int32_t texel, int32_t chart) {
  const size_t i = builder.owned_index(texel);
  double area = 0.0;
  for (int32_t f = builder.table.fragment_begin[i]; f < builder.table.fragment_begin[i + 1]; ++f) {
    const int32_t triangle = builder.table.fragment_triangle[f];
    if (builder.chart_of(triangle) == chart) area += builder.table.fragment_share[f];
  }
  return area;
}

double total_area(const TexelTableBuilder& builder) {
  const std::vector<float>& areas = builder.table.fragment_share;
  return std::accumulate(areas.begin(), areas.end(), 0.0);
}

/// Four whole texels and six tenths of the fifth, which also holds a speck of a chart.
Layout wide_and_speck() {
  return Layout().rectangle(0.0, 0.0, 4.6, 1.0).rectangle(4.7, 0.2, 4.9, 0.4);
}

TEST(CutMap, GivesATexelToTheChartThatCoversMostOfIt) {
  const Layout layout = wide_and_speck();
  const TexelTableBuilder builder = layout.cut();
  EXPECT_THAT(builder.table.texel, ElementsAre(0, 1, 2, 3, 4));
  EXPECT_THAT(builder.table.chart, ElementsAre(0, 0, 0, 0, 0));
  EXPECT_THAT(builder.own_texels, ElementsAre(5, 0));
  ASSERT_EQ(builder.displaced.size(), 2u);
  EXPECT_EQ(builder.displaced[0].texel, 4);
  EXPECT_NEAR(builder.displaced[0].area + builder.displaced[1].area, 0.04, 1e-6);
}

TEST(SmallCharts, TakeTheTexelTheyLieInWhereItsOwnerHasOthers) {
  const Layout layout = wide_and_speck();
  TexelTableBuilder builder = layout.cut();
  assign_texels_to_small_charts(builder);
  EXPECT_THAT(builder.table.chart, ElementsAre(0, 0, 0, 0, 1));
  EXPECT_EQ(builder.table.unmapped_charts, 0);
  EXPECT_NEAR(area_in(builder, 4, 1), 0.04, 1e-6);
  double displaced = 0.0;
  for (const Fragment& f : builder.displaced) {
    EXPECT_EQ(builder.chart_of(f.triangle), 0);
    displaced += f.area;
  }
  EXPECT_NEAR(displaced, 0.6, 1e-6);
}

TEST(SmallCharts, AreUnmappedWhereTheOwnerHasNothingElse) {
  const Layout layout = Layout().rectangle(0.0, 0.0, 0.6, 1.0).rectangle(0.7, 0.2, 0.9, 0.4);
  TexelTableBuilder builder = layout.cut();
  assign_texels_to_small_charts(builder);
  EXPECT_THAT(builder.table.chart, ElementsAre(0));
  EXPECT_EQ(builder.table.unmapped_charts, 1);
}

TEST(SmallCharts, DoNotTakeFromEachOther) {
  const Layout layout = wide_and_speck().rectangle(4.7, 0.6, 4.9, 0.9);
  TexelTableBuilder builder = layout.cut();
  assign_texels_to_small_charts(builder);
  EXPECT_THAT(builder.table.chart, ElementsAre(0, 0, 0, 0, 1));
  EXPECT_EQ(builder.table.unmapped_charts, 1);
}

TEST(DisplacedFragments, GoToTheirChartsNearestTexel) {
  const Layout layout = wide_and_speck();
  TexelTableBuilder builder = layout.cut();
  assign_texels_to_small_charts(builder);
  reassign_displaced_fragments(builder);
  EXPECT_NEAR(area_in(builder, 3, 0), 1.6, 1e-6);
  EXPECT_NEAR(area_in(builder, 4, 0), 0.0, 1e-6);
  EXPECT_NEAR(total_area(builder), 4.64, 1e-5);
}

TEST(DisplacedFragments, OfAnUnmappedChartStayWhereTheyAre) {
  const Layout layout = Layout().rectangle(0.0, 0.0, 0.6, 1.0).rectangle(0.7, 0.2, 0.9, 0.4);
  TexelTableBuilder builder = layout.cut();
  assign_texels_to_small_charts(builder);
  reassign_displaced_fragments(builder);
  EXPECT_NEAR(area_in(builder, 0, 1), 0.04, 1e-6);
  EXPECT_NEAR(total_area(builder), 0.64, 1e-5);
}

}  // namespace
}  // namespace snowbough::snow
