#include "snow/seams/seam_samples.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "snow/texels/charts.h"

namespace snowbough::snow {
namespace {

/// The seam of a strip of two squares of 16 x 16 texels; the second begins at column `column` and
/// row `row` of the map, the first at column 8 and row 8.
SeamLevelling gaps_of_cut_strip(float column, float row, TexelTable& table) {
  MapTopology topology;
  topology.resolution = 64;
  topology.vertex_count = 6;
  topology.triangles = {0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4};
  for (const glm::vec2 low : {glm::vec2(8, 8), glm::vec2(column, row)}) {
    const auto uv = [&](float x, float y) { return (low + glm::vec2(x, y)) / 64.0f; };
    for (const glm::vec2 corner :
         {uv(0, 0), uv(16, 0), uv(16, 16), uv(0, 0), uv(16, 16), uv(0, 16)}) {
      topology.corner_uv.push_back(corner);
    }
  }
  table = build_texel_table(topology);
  std::vector<int32_t> owned(64 * 64, -1);
  for (size_t i = 0; i < table.texel.size(); ++i) owned[table.texel[i]] = static_cast<int32_t>(i);
  return find_seam_gaps(topology, table, find_charts(topology), owned, 0.2f);
}

TEST(SeamGaps, areTheDifferencesBetweenBothSides) {
  TexelTable table;
  const SeamLevelling gaps = gaps_of_cut_strip(40, 8, table);
  EXPECT_FLOAT_EQ(gaps.least_height, 0.005f);
  EXPECT_EQ(gaps.points.size(), 4u * 16);
  // Two columns on either side of both edges, and a row beyond either end.
  EXPECT_EQ(gaps.unknowns, 4 * 18);
  EXPECT_EQ(gaps.texel.size(), 4u * 18);
  EXPECT_TRUE(std::is_sorted(gaps.texel.begin(), gaps.texel.end()));
  for (const SeamRow& point : gaps.points) {
    float sum = 0.0f;
    float size = 0.0f;
    for (const float weight : point.weight) {
      sum += weight;
      size += std::abs(weight);
    }
    EXPECT_NEAR(sum, 0.0f, 1e-6f);
    EXPECT_NEAR(size, 2.0f, 1e-6f);
  }
}

TEST(SeamGaps, anotherChartsTexelsAreOnlyRead) {
  // The second square begins where the first ends, four rows higher up: 12 rows touch.
  TexelTable table;
  const SeamLevelling gaps = gaps_of_cut_strip(24, 12, table);
  ASSERT_GT(gaps.texel.size(), static_cast<size_t>(gaps.unknowns));
  for (size_t i = static_cast<size_t>(gaps.unknowns); i < gaps.texel.size(); ++i) {
    EXPECT_TRUE(std::binary_search(table.texel.begin(), table.texel.end(), gaps.texel[i]));
  }
  EXPECT_EQ(gaps.texel.size() - static_cast<size_t>(gaps.unknowns), 2u * 13);
}

}  // namespace
}  // namespace snowbough::snow
