#include "snow/texels/charts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "native/snow/texels/quads.h"

namespace snowbough::snow {
namespace {

using ::testing::ElementsAre;

TEST(Charts, trianglesWithEqualUvsOnAnEdgeAreOneChart) {
  const Charts charts = find_charts(quad_map(0, 0, 1, 1, 64));
  EXPECT_THAT(charts.chart, ElementsAre(0, 0));
  EXPECT_EQ(charts.seams.size(), 0u);
  EXPECT_EQ(charts.open_edges.size(), 4u);
}

TEST(Charts, anEdgeWithTwoUvsIsASeam) {
  const Charts charts = find_charts(
      topology_of({0, 1, 2, 0, 2, 3},
                  {{0, 0}, {0.4f, 0}, {0.4f, 0.4f}, {0.5f, 0}, {0.9f, 0.4f}, {0.5f, 0.4f}}, 64));
  EXPECT_THAT(charts.chart, ElementsAre(0, 1));
  ASSERT_EQ(charts.seams.size(), 1u);
  EXPECT_EQ(charts.seams[0].a.edge, 2);
  EXPECT_EQ(charts.seams[0].b.edge, 0);
  EXPECT_FALSE(charts.seams[0].same_direction);
}

TEST(Charts, neighboursOfOppositeWindingMeetInTheSameDirection) {
  const Charts charts = find_charts(
      topology_of({0, 1, 2, 2, 0, 3},
                  {{0, 0}, {0.4f, 0}, {0.4f, 0.4f}, {0.5f, 0}, {0.9f, 0.4f}, {0.5f, 0.4f}}, 64));
  ASSERT_EQ(charts.seams.size(), 1u);
  EXPECT_TRUE(charts.seams[0].same_direction);
}

}  // namespace
}  // namespace snowbough::snow
