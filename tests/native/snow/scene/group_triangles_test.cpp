// Triangles that determine whether a work group of texels is active.
#include "snow/scene/group_triangles.h"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <utility>

#include "shaders/lib/snow_shared.h"
#include "snow/texels/texel_order.h"

namespace snowbough::snow {
namespace {

/// A map of cells x cells quads with joint vertices. Where `split`, its left and its right half
/// have vertices of their own: two charts.
MapTopology quads(int32_t cells, int32_t resolution, bool split) {
  MapTopology topology;
  topology.resolution = resolution;
  const int32_t columns = cells + (split ? 2 : 1);
  topology.vertex_count = columns * (cells + 1);
  for (int32_t y = 0; y < cells; ++y) {
    for (int32_t x = 0; x < cells; ++x) {
      const int32_t left = y * columns + x + (split && x >= cells / 2 ? 1 : 0);
      for (const auto& [dx, dy] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}}) {
        topology.triangles.push_back(left + dx + dy * columns);
        topology.corner_uv.emplace_back(glm::vec2(x + dx, y + dy) / static_cast<float>(cells));
      }
    }
  }
  return topology;
}

/// The header's definition, evaluated texel by texel.
std::vector<std::set<uint32_t>> expected(const TexelTable& table,
                                         const std::vector<int32_t>& order) {
  const auto group_count = (order.size() + shared::kTexelGroup - 1) / shared::kTexelGroup;
  std::vector<std::set<uint32_t>> groups(group_count);
  for (size_t at = 0; at < order.size(); ++at) {
    const int32_t i = order[at];
    for (int32_t f = table.fragment_begin[i]; f < table.fragment_begin[i + 1]; ++f) {
      groups[at / shared::kTexelGroup].insert(static_cast<uint32_t>(table.fragment_triangle[f]));
    }
  }
  return groups;
}

std::set<uint32_t> group(const GroupTriangles& groups, size_t g) {
  return {groups.triangles.begin() + groups.begin[g],
          groups.triangles.begin() + groups.begin[g + 1]};
}

TEST(GroupTriangles, areThoseOnTheGroup) {
  for (const bool split : {false, true}) {
    for (const int32_t resolution : {64, 100}) {
      SCOPED_TRACE(std::to_string(resolution) + (split ? ", two charts" : ", one chart"));
      const TexelTable table = build_texel_table(quads(16, resolution, split));
      ASSERT_EQ(table.chart_count, split ? 2 : 1);
      const std::vector<int32_t> order = texel_order(table);
      GroupTriangles groups;
      add_group_triangles(table, order, 0, groups);
      const auto wanted = expected(table, order);
      ASSERT_EQ(groups.begin.size(), wanted.size() + 1);
      for (size_t g = 0; g < wanted.size(); ++g) EXPECT_EQ(group(groups, g), wanted[g]);
      EXPECT_LT(groups.begin[1], 512u) << "not all triangles";
    }
  }
}

TEST(GroupTriangles, ofASecondReceiverFollowWithTheirOwnNumbers) {
  const TexelTable table = build_texel_table(quads(16, 64, false));
  const std::vector<int32_t> order = texel_order(table);
  GroupTriangles groups;
  add_group_triangles(table, order, 0, groups);
  add_group_triangles(table, order, 1000, groups);
  ASSERT_EQ(groups.begin.size(), 9u);
  std::set<uint32_t> moved;
  for (const uint32_t triangle : group(groups, 1)) moved.insert(triangle + 1000);
  EXPECT_EQ(group(groups, 5), moved);
}

TEST(GroupTriangles, ofNothingAreNone) {
  TexelTable table;
  table.resolution = 64;
  GroupTriangles groups;
  add_group_triangles(table, {}, 0, groups);
  EXPECT_EQ(groups.begin.size(), 1u);
}

}  // namespace
}  // namespace snowbough::snow
