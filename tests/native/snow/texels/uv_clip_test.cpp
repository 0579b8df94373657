#include "snow/texels/uv_clip.h"

#include <gtest/gtest.h>

#include <bit>

namespace snowbough::snow {
namespace {

ClipPolygon polygon(std::vector<glm::dvec2> points) {
  ClipPolygon result;
  for (const glm::dvec2 point : points) result.points[result.count++] = point;
  return result;
}

TEST(AreaAndCentroid, areTheSameForBothWindings) {
  for (const ClipPolygon& triangle :
       {polygon({{1, 1}, {4, 1}, {1, 4}}), polygon({{1, 1}, {1, 4}, {4, 1}})}) {
    const AreaCentroid found = area_and_centroid(triangle);
    EXPECT_DOUBLE_EQ(found.area, 4.5);
    EXPECT_DOUBLE_EQ(found.centroid.x, 2.0);
    EXPECT_DOUBLE_EQ(found.centroid.y, 2.0);
  }
}

TEST(AreaAndCentroid, takesTheMeanOfPointsOnALine) {
  const AreaCentroid found = area_and_centroid(polygon({{0, 0}, {1, 1}, {5, 5}}));
  EXPECT_EQ(found.area, 0.0);
  EXPECT_DOUBLE_EQ(found.centroid.x, 2.0);
}

TEST(SampleRow, bitsGoByRowsFromTheLowerLeft) {
  // Below the diagonal from (0, 0) to (1, 1): row r holds the columns right of it.
  const SampleEdges edges(UvTriangle{glm::dvec2(0, 0), glm::dvec2(1, 0), glm::dvec2(1, 1)});
  const uint64_t mask = SampleRow(edges, 0).mask(0);
  EXPECT_EQ(mask & 0xFF, 0xFFu);
  EXPECT_EQ(mask >> 56, 0x80u);
}

TEST(SampleRow, adjacentTrianglesCoverEachSampleOnce) {
  const SampleEdges below(UvTriangle{glm::dvec2(0, 0), glm::dvec2(1, 0), glm::dvec2(1, 1)});
  const SampleEdges above(UvTriangle{glm::dvec2(0, 0), glm::dvec2(1, 1), glm::dvec2(0, 1)});
  const uint64_t a = SampleRow(below, 0).mask(0);
  const uint64_t b = SampleRow(above, 0).mask(0);
  EXPECT_EQ(a & b, 0u);
  EXPECT_EQ(a | b, ~uint64_t{0});
}

TEST(SampleRow, texelsBesideTheTriangleHaveNone) {
  const SampleEdges edges(UvTriangle{glm::dvec2(1, 0), glm::dvec2(2, 0), glm::dvec2(2, 1)});
  EXPECT_EQ(SampleRow(edges, 0).mask(0), 0u);
  EXPECT_EQ(SampleRow(edges, 0).mask(2), 0u);
  EXPECT_EQ(SampleRow(edges, 1).mask(1), 0u);
}

TEST(CutTriangle, partsComeByRowsAndColumnsAndAddUpToTheTriangle) {
  TriangleCuts cuts;
  const double sum = cut_triangle(
      {glm::dvec2(0.5, 0.5), glm::dvec2(3.5, 0.5), glm::dvec2(0.5, 3.5)}, 7, 8, 0, 8, cuts);
  double area = 0.0;
  for (size_t i = 0; i < cuts.parts.size(); ++i) {
    EXPECT_EQ(cuts.parts[i].triangle, 7);
    EXPECT_TRUE(i == 0 || cuts.parts[i - 1].texel < cuts.parts[i].texel);
    area += cuts.parts[i].area;
  }
  ASSERT_EQ(cuts.whole.size(), 1u);
  EXPECT_EQ(cuts.whole[0].first_texel, 1 * 8 + 1);
  EXPECT_NEAR(area + cuts.whole[0].count, 4.5, 1e-12);
  EXPECT_NEAR(sum, 4.5, 1e-12);
}

TEST(CutTriangle, texelsInsideAreOneRun) {
  TriangleCuts cuts;
  cut_triangle({glm::dvec2(0, 0), glm::dvec2(8, 0), glm::dvec2(0, 8)}, 3, 8, 2, 3, cuts);
  ASSERT_EQ(cuts.whole.size(), 1u);  // row 2 only: five whole ones and the one on the slope
  EXPECT_EQ(cuts.whole[0].first_texel, 2 * 8);
  EXPECT_EQ(cuts.whole[0].count, 5);
  EXPECT_EQ(cuts.whole[0].triangle, 3);
  ASSERT_EQ(cuts.parts.size(), 1u);
  EXPECT_EQ(cuts.parts[0].texel, 2 * 8 + 5);
  EXPECT_DOUBLE_EQ(cuts.parts[0].area, 0.5);
}

TEST(CutTriangle, aWholeTexelHasAllItsSamples) {
  const Fragment fragment = whole_fragment(2 * 8 + 1, 4, 8);
  EXPECT_EQ(fragment.area, 1.0);
  EXPECT_EQ(fragment.centroid, glm::dvec2(1.5, 2.5));
  EXPECT_EQ(std::popcount(fragment.samples), 64);
}

}  // namespace
}  // namespace snowbough::snow
