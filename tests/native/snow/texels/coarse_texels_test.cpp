#include "snow/texels/coarse_texels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <glm/vec4.hpp>
#include <numeric>
#include <vector>

namespace snowbough::snow {
namespace {

/// A square in each of the rectangles, given by the map's left, lower, right and upper border.
TexelTable table_of(const std::vector<glm::vec4>& rectangles) {
  MapTopology topology;
  topology.resolution = 64;
  for (const glm::vec4& box : rectangles) {
    const glm::vec2 uv[4] = {{box.x, box.y}, {box.z, box.y}, {box.z, box.w}, {box.x, box.w}};
    for (const size_t k : {0, 1, 2, 0, 2, 3}) {
      topology.triangles.push_back(topology.vertex_count + static_cast<int32_t>(k));
      topology.corner_uv.push_back(uv[k]);
    }
    topology.vertex_count += 4;
  }
  return build_texel_table(topology);
}

/// By triangle: the sum of the shares of its fragments.
std::vector<double> shares(const TexelTable& table) {
  std::vector<double> sums(8, 0.0);
  for (size_t f = 0; f < table.fragment_triangle.size(); ++f) {
    sums[static_cast<size_t>(table.fragment_triangle[f])] +=
        static_cast<double>(table.fragment_share[f]);
  }
  return sums;
}

TEST(CoarseTexels, CoverAllOfEveryTriangle) {
  // Two charts that meet within squares of 2 x 2 texels.
  const TexelTable fine = table_of({{0.0f, 0.0f, 0.4f, 0.9f}, {0.42f, 0.0f, 1.0f, 0.9f}});
  const std::optional<CoarseTexels> coarse = join_texels(fine, 2);
  ASSERT_TRUE(coarse.has_value());
  EXPECT_EQ(coarse->table.resolution, 32);
  const std::vector<double> before = shares(fine);
  const std::vector<double> after = shares(coarse->table);
  for (size_t t = 0; t < 4; ++t) EXPECT_NEAR(after[t], before[t], 1e-5);
  EXPECT_TRUE(std::is_sorted(coarse->table.texel.begin(), coarse->table.texel.end()));
}

TEST(CoarseTexels, JoinTexelsOfOneChart) {
  const TexelTable fine = table_of({{0.0f, 0.0f, 0.4f, 0.9f}, {0.42f, 0.0f, 1.0f, 0.9f}});
  const std::optional<CoarseTexels> coarse = join_texels(fine, 2);
  ASSERT_TRUE(coarse.has_value());
  for (size_t i = 0; i < fine.texel.size(); ++i) {
    const auto parent = static_cast<size_t>(coarse->parent[i]);
    EXPECT_EQ(coarse->table.chart[parent], fine.chart[i]);
    EXPECT_EQ(
        std::count(coarse->texel.begin() + coarse->begin[parent],
                   coarse->texel.begin() + coarse->begin[parent + 1], static_cast<int32_t>(i)),
        1);
  }
}

TEST(CoarseTexels, AreNotMadeIfAChartWouldBeLost) {
  // A chart of one texel in the corner of another's square.
  const TexelTable fine = table_of({{0.0f, 0.0f, 0.5f, 0.98f},
                                    {32.0f / 64, 0.5f, 33.0f / 64, 33.0f / 64},
                                    {33.0f / 64, 0.0f, 1.0f, 0.98f}});
  EXPECT_FALSE(join_texels(fine, 2).has_value());
}

TEST(CoarseTexels, AreNoneOnSmallMaps) {
  EXPECT_FALSE(join_texels(table_of({{0.0f, 0.0f, 1.0f, 1.0f}}), 4).has_value());
}

}  // namespace
}  // namespace snowbough::snow
