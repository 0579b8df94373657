#include "snow/movement/repose/links.h"

#include <gtest/gtest.h>

#include <array>
#include <glm/geometric.hpp>
#include <memory>
#include <utility>
#include <vector>

namespace snowbough::snow {
namespace {

/// Squares of one metre side by side along x, `columns` of them, each a chart of its own on a map
/// of 64 texels or, where `in_one_chart`, all of them one. With vertices of their own where
/// `split`.
struct Strip {
  MapTopology topology;
  std::vector<glm::vec3> positions;
  TexelTable table;
  ReposeLinks links;
};

void add_square(Strip& strip, const std::vector<int32_t>& corners, glm::vec2 low, glm::vec2 high) {
  const glm::vec2 uv[4] = {low, {high.x, low.y}, high, {low.x, high.y}};
  for (const int32_t k : {0, 1, 2, 0, 2, 3}) {
    strip.topology.triangles.push_back(corners[static_cast<size_t>(k)]);
    strip.topology.corner_uv.push_back(uv[k]);
  }
}

void finish(Strip& strip) {
  strip.topology.resolution = 64;
  strip.topology.vertex_count = static_cast<int32_t>(strip.positions.size());
  strip.table = build_texel_table(strip.topology);
  strip.links = find_repose_links(strip.topology, strip.table, strip.positions);
}

/// Two squares that share an edge at x = 1, on the map from u = 0 to 0.25 and from u = 0.5 to 0.75.
Strip two_charts(bool split, float gap = 0.0f) {
  Strip strip;
  strip.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {2 + gap, 0, 0}, {2 + gap, 1, 0}};
  if (split) {
    strip.positions.push_back({1 + gap, 0, 0});
    strip.positions.push_back({1 + gap, 1, 0});
  }
  const int32_t low = split ? 6 : 1;
  add_square(strip, {0, 1, 2, 3}, {0.0f, 0.0f}, {0.25f, 0.25f});
  add_square(strip, {low, 4, 5, low + 1}, {0.5f, 0.0f}, {0.75f, 0.25f});
  finish(strip);
  return strip;
}

/// The number of forward links of kind `k`.
int64_t count(const ReposeLinks& links, int32_t k) {
  return std::count_if(links.forward.begin(), links.forward.end(),
                       [&](uint8_t bits) { return ((bits >> k) & 1) != 0; });
}

TEST(ReposeLinks, JoinTexelsOfAChartWithTheirEightNeighbours) {
  const Strip strip = two_charts(false);
  // Two charts of 16 x 16 texels.
  EXPECT_EQ(count(strip.links, 0), 2 * 15 * 16);
  EXPECT_EQ(count(strip.links, 1), 2 * 15 * 16);
  EXPECT_EQ(count(strip.links, 2), 2 * 15 * 15);
  EXPECT_EQ(count(strip.links, 3), 2 * 15 * 15);
}

TEST(ReposeLinks, JoinTheTexelsThatMeetAtASeam) {
  const Strip strip = two_charts(false);
  ASSERT_EQ(strip.links.across.size(), 16u);
  for (const ReposeLinks::Across& link : strip.links.across) {
    const int32_t a = strip.table.texel[static_cast<size_t>(link.a)];
    const int32_t b = strip.table.texel[static_cast<size_t>(link.b)];
    EXPECT_EQ(a % 64, 15);
    EXPECT_EQ(b % 64, 32);
    EXPECT_EQ(a / 64, b / 64);
    // In the middle of the texels' sides.
    const int32_t* corners = &strip.topology.triangles[3 * static_cast<size_t>(link.seam.triangle)];
    const auto at = [&](int k) { return strip.positions[static_cast<size_t>(corners[k])]; };
    const glm::vec3 point =
        at(0) + link.seam.weights.x * (at(1) - at(0)) + link.seam.weights.y * (at(2) - at(0));
    EXPECT_NEAR(point.x, 1.0f, 1e-5f);
  }
  // Every end is listed once on either side.
  EXPECT_EQ(strip.links.ends.size(), 2 * 16 + strip.links.open_edges.size());
}

TEST(ReposeLinks, TakeASplitEdgeForASeamButNotAGap) {
  const auto ends = [](const Strip& strip) {
    std::vector<std::pair<int32_t, int32_t>> all;
    for (const ReposeLinks::Across& link : strip.links.across) all.push_back(link.ends());
    return all;
  };
  EXPECT_EQ(ends(two_charts(true)), ends(two_charts(false)));
  EXPECT_TRUE(two_charts(true, 0.01f).links.across.empty());
}

TEST(ReposeLinks, FindTheOpenEdgesRoundTheSurface) {
  const Strip strip = two_charts(false);
  // Six sides of 16 texels: the seam is not an open edge.
  EXPECT_EQ(strip.links.open_edges.size(), 6u * 16u);
  for (const ReposeLinks::OpenEdge& edge : strip.links.open_edges) {
    const int32_t* corners =
        &strip.topology.triangles[3 * static_cast<size_t>(edge.point.triangle)];
    const auto at = [&](int k) { return strip.positions[static_cast<size_t>(corners[k])]; };
    const glm::vec3 point =
        at(0) + edge.point.weights.x * (at(1) - at(0)) + edge.point.weights.y * (at(2) - at(0));
    EXPECT_TRUE(point.x == 0.0f || point.x == 2.0f || point.y == 0.0f || point.y == 1.0f);
  }
}

TEST(ReposeLinks, KeepSheetsApartThatOnlyTouchOnTheMap) {
  Strip strip;
  strip.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                     {5, 0, 0}, {6, 0, 0}, {6, 1, 0}, {5, 1, 0}};
  add_square(strip, {0, 1, 2, 3}, {0.0f, 0.0f}, {0.25f, 0.25f});
  add_square(strip, {4, 5, 6, 7}, {0.25f, 0.0f}, {0.5f, 0.25f});
  finish(strip);
  EXPECT_TRUE(strip.links.across.empty());
  EXPECT_EQ(count(strip.links, 0), 2 * 15 * 16);
}

TEST(ReposeLinks, LeaveSnowWhereThreeSheetsMeet) {
  Strip strip;
  strip.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                     {2, 0, 0}, {2, 1, 0}, {1, 0, 1}, {1, 1, 1}};
  add_square(strip, {0, 1, 2, 3}, {0.0f, 0.0f}, {0.2f, 0.25f});
  add_square(strip, {1, 4, 5, 2}, {0.3f, 0.0f}, {0.5f, 0.25f});
  add_square(strip, {1, 6, 7, 2}, {0.6f, 0.0f}, {0.8f, 0.25f});
  finish(strip);
  EXPECT_TRUE(strip.links.across.empty());
  for (const ReposeLinks::OpenEdge& edge : strip.links.open_edges) {
    const int32_t* corners =
        &strip.topology.triangles[3 * static_cast<size_t>(edge.point.triangle)];
    const auto at = [&](int k) { return strip.positions[static_cast<size_t>(corners[k])]; };
    const glm::vec3 point =
        at(0) + edge.point.weights.x * (at(1) - at(0)) + edge.point.weights.y * (at(2) - at(0));
    EXPECT_FALSE(point.x == 1.0f && point.z == 0.0f);
  }
}

TEST(ReposeLinks, FindTheRunsOfARow) {
  using Run = std::array<int32_t, 3>;
  const auto runs = [](const Strip& strip, int32_t block, int32_t margin) {
    std::vector<Run> all;
    strip.links.for_row_runs(block, 1, margin, strip.table.texel,
                             [&](int32_t first, int32_t count, int32_t column) {
                               all.push_back({first, count, column});
                             });
    return all;
  };
  // The second row of texels, in columns 0 to 15 and 32 to 47 of the map.
  const Strip apart = two_charts(false);
  EXPECT_EQ(runs(apart, 0, 0), (std::vector<Run>{{32, 16, 0}}));
  EXPECT_EQ(runs(apart, 0, 1), (std::vector<Run>{{32, 16, 0}, {48, 1, 32}}));
  EXPECT_EQ(runs(apart, 1, 1), (std::vector<Run>{{48, 16, 0}}));
  EXPECT_EQ(runs(apart, 2, 1), std::vector<Run>{});
}

TEST(ReposeLinkTables, CopiesThatShareATableHaveEqualLinks) {
  const Strip strip = two_charts(false);
  const auto table = std::make_shared<const TexelTable>(strip.table);
  const std::shared_ptr<const TexelTable> other = table;
  std::vector<glm::vec3> moved = strip.positions;
  for (glm::vec3& point : moved) point += glm::vec3(0.3f, 0.7f, 5.1f);
  ReposeLinkTables tables;
  for (const auto& positions : {strip.positions, moved}) {
    const auto links = tables.find(strip.topology, table, positions);
    EXPECT_EQ(links->forward, strip.links.forward);
    EXPECT_EQ(links->across.size(), strip.links.across.size());
    EXPECT_EQ(links->open_edges.size(), strip.links.open_edges.size());
  }
}

TEST(ReposeLinkTables, CopiesThatAreTornOpenHaveLinksOfTheirOwn) {
  const Strip whole = two_charts(true);
  const Strip torn = two_charts(true, 0.1f);
  ASSERT_NE(whole.links.open_edges.size(), torn.links.open_edges.size());
  const auto table = std::make_shared<const TexelTable>(whole.table);
  const std::shared_ptr<const TexelTable> other = table;
  ReposeLinkTables tables;
  EXPECT_EQ(tables.find(whole.topology, table, whole.positions)->open_edges.size(),
            whole.links.open_edges.size());
  EXPECT_EQ(tables.find(torn.topology, table, torn.positions)->open_edges.size(),
            torn.links.open_edges.size());
}

}  // namespace
}  // namespace snowbough::snow
