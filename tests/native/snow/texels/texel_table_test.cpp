#include "snow/texels/texel_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <map>
#include <random>
#include <set>

#include "native/snow/texels/quads.h"

namespace snowbough::snow {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<double> share_sums(const TexelTable& table, size_t triangle_count) {
  std::vector<double> sums(triangle_count, 0.0);
  for (size_t f = 0; f < table.fragment_share.size(); ++f) {
    sums[table.fragment_triangle[f]] += table.fragment_share[f];
  }
  return sums;
}

std::string refusal(const MapTopology& topology) {
  try {
    build_texel_table(topology);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

TEST(TexelTable, aQuadOverTheWholeMapOwnsEveryTexel) {
  const TexelTable table = build_texel_table(quad_map(0, 0, 1, 1, 64));
  EXPECT_EQ(table.texel.size(), 64u * 64u);
  EXPECT_THAT(table.coverage, Each(1.0f));
  EXPECT_EQ(table.overlap, 0.0f);
  EXPECT_EQ(table.degenerate_triangles, 0);
  EXPECT_THAT(share_sums(table, 2), Each(testing::DoubleNear(1.0, 1e-6)));
}

TEST(TexelTable, aStripOneAndAHalfTexelsWideLosesNothing) {
  // Columns 10.25 to 11.75: two texels per row, at least half covered, centres inside.
  const TexelTable table = build_texel_table(quad_map(10.25f / 64, 0, 11.75f / 64, 1, 64));
  EXPECT_EQ(table.texel.size(), 128u);
  EXPECT_THAT(table.coverage, Each(testing::FloatNear(0.75f, 1e-5f)));
  EXPECT_THAT(share_sums(table, 2), Each(testing::DoubleNear(1.0, 1e-6)));
}

TEST(TexelTable, aThinStripBetweenCentresIsSampledInItsMiddle) {
  const TexelTable table = build_texel_table(quad_map(10.0f / 64, 0, 10.25f / 64, 1, 64));
  ASSERT_EQ(table.texel.size(), 64u);
  EXPECT_THAT(table.coverage, Each(testing::FloatNear(0.25f, 1e-5f)));
  const MapTopology topology = quad_map(10.0f / 64, 0, 10.25f / 64, 1, 64);
  for (size_t i = 0; i < table.texel.size(); ++i) {
    const glm::vec2* uv = topology.corner_uv.data() + 3 * table.triangle[i];
    const glm::vec2 w = table.barycentric[i];
    const glm::vec2 p = uv[0] * (1 - w.x - w.y) + uv[1] * w.x + uv[2] * w.y;
    EXPECT_NEAR(p.x * 64, 10.125f, 1e-4f);
    EXPECT_NEAR(p.y * 64, static_cast<float>(i) + 0.5f, 1e-4f);
  }
}

TEST(TexelTable, aTexelBelongsToTheChartThatCoversMostOfIt) {
  MapTopology topology = quad_map(0, 0, 10.3f / 64, 1, 64);
  add_quad(topology, 10.3f / 64, 0, 20.0f / 64, 1);
  const TexelTable table = build_texel_table(topology);
  for (size_t i = 0; i < table.texel.size(); ++i) {
    EXPECT_EQ(table.chart[i], table.texel[i] % 64 < 10 ? 0 : 1);
  }
  EXPECT_THAT(share_sums(table, 4), Each(testing::DoubleNear(1.0, 1e-6)));
}

TEST(TexelTable, displacedFragmentsGoToTheNearestTexelOfTheirChart) {
  MapTopology topology = quad_map(0, 0, 10.3f / 64, 1, 64);
  add_quad(topology, 10.3f / 64, 0, 20.0f / 64, 1);
  const TexelTable table = build_texel_table(topology);
  // Column 9 of chart 0 carries its own texel and the 0.3 beside it.
  std::vector<double> column(64, 0.0);
  for (size_t i = 0; i < table.texel.size(); ++i) {
    for (int32_t f = table.fragment_begin[i]; f < table.fragment_begin[i + 1]; ++f) {
      EXPECT_EQ(table.fragment_triangle[f] / 2, table.chart[i]);
      if (table.chart[i] == 0) column[table.texel[i] % 64] += table.fragment_share[f];
    }
  }
  EXPECT_NEAR(column[9] / column[8], 1.3, 1e-4);
}

TEST(TexelTable, aSmallChartOwnsTheTexelUnderIt) {
  MapTopology topology = quad_map(0, 0, 0.5f, 1, 64);
  add_quad(topology, 3.1f / 64, 3.1f / 64, 3.2f / 64, 3.2f / 64);
  const TexelTable table = build_texel_table(topology);
  const auto at =
      std::find(table.texel.begin(), table.texel.end(), 3 * 64 + 3) - table.texel.begin();
  EXPECT_EQ(table.chart[at], 1);
  EXPECT_NEAR(table.coverage[at], 0.01f, 1e-5f);
  EXPECT_EQ(table.unmapped_charts, 0);
  EXPECT_EQ(table.texel.size(), 32u * 64u);
  EXPECT_THAT(share_sums(table, 4), Each(testing::DoubleNear(1.0, 1e-5)));
}

TEST(TexelTable, chartsWithoutATexelAreCountedAsUnmappedAndKeepTheirArea) {
  MapTopology topology;
  topology.resolution = 64;
  for (int i = 0; i < 3; ++i) add_quad(topology, 0.001f * i, 0, 0.001f * i + 0.001f, 0.01f);
  const TexelTable table = build_texel_table(topology);
  EXPECT_EQ(table.texel.size(), 1u);
  EXPECT_EQ(table.unmapped_charts, 2);
  EXPECT_THAT(share_sums(table, 6), Each(testing::DoubleNear(1.0, 1e-6)));
}

TEST(TexelTable, twoSmallChartsDoNotTakeTheSameTexel) {
  MapTopology topology = quad_map(0, 0, 4.6f / 64, 1.0f / 64, 64);
  add_quad(topology, 4.7f / 64, 0.2f / 64, 4.9f / 64, 0.4f / 64);
  add_quad(topology, 4.7f / 64, 0.6f / 64, 4.9f / 64, 0.9f / 64);
  const TexelTable table = build_texel_table(topology);
  EXPECT_THAT(table.chart, ElementsAre(0, 0, 0, 0, 1));
  EXPECT_EQ(table.unmapped_charts, 1);
}

TEST(TexelTable, trianglesWithoutUvAreaAreCounted) {
  MapTopology topology = quad_map(0, 0, 0.5f, 0.5f, 64);
  const int32_t v = topology.vertex_count;
  topology.vertex_count += 3;
  topology.triangles.insert(topology.triangles.end(), {v, v + 1, v + 2});
  topology.corner_uv.insert(topology.corner_uv.end(), {{0.6f, 0.6f}, {0.7f, 0.7f}, {0.8f, 0.8f}});
  const TexelTable table = build_texel_table(topology);
  EXPECT_EQ(table.degenerate_triangles, 1);
  EXPECT_NEAR(share_sums(table, 3)[2], 0.0, 0.0);
}

TEST(TexelTable, overlapIsTheShareOfAreaThatIsCoveredTwice) {
  MapTopology topology = quad_map(0, 0, 0.5f, 1, 64);
  add_quad(topology, 0.25f, 0, 0.5f, 1);
  EXPECT_NEAR(build_texel_table(topology).overlap, 0.5f, 1e-6f);
}

TEST(TexelTable, mirroredTrianglesAreCutLikeOthers) {
  const TexelTable table = build_texel_table(topology_of({0, 1, 2}, {{0, 0}, {0, 1}, {1, 0}}, 64));
  EXPECT_EQ(table.texel.size(), 64u * 65u / 2u);
  EXPECT_THAT(share_sums(table, 1), Each(testing::DoubleNear(1.0, 1e-5)));
}

TEST(TexelTable, badInputIsRefusedWithWhatIsWrong) {
  EXPECT_THAT(refusal(quad_map(0, 0, 1, 1, 32)), HasSubstr("64 to 8192"));
  EXPECT_THAT(refusal(quad_map(0, 0, 1.01f, 1, 64)), HasSubstr("3 of 6"));
  EXPECT_THAT(refusal(quad_map(0, 0, std::nanf(""), 1, 64)), HasSubstr("3 of 6"));
  MapTopology topology = quad_map(0, 0, 1, 1, 64);
  topology.corner_uv.pop_back();
  EXPECT_THAT(refusal(topology), HasSubstr("6, not 5"));
  topology = quad_map(0, 0, 1, 1, 64);
  topology.triangles[4] = 4;
  EXPECT_THAT(refusal(topology), HasSubstr("index 4"));
}

/// Triangles of random shape, size and place: separate, overlapping, across many texels or inside
/// one.
MapTopology random_triangles(uint32_t seed, int32_t count, int32_t resolution) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  MapTopology topology;
  topology.resolution = resolution;
  for (int32_t t = 0; t < count; ++t) {
    const glm::vec2 centre(unit(random), unit(random));
    const float size = std::pow(10.0f, -3.0f * unit(random));
    for (int k = 0; k < 3; ++k) {
      topology.triangles.push_back(topology.vertex_count++);
      const glm::vec2 corner = centre + size * (glm::vec2(unit(random), unit(random)) - 0.5f);
      topology.corner_uv.emplace_back(std::clamp(corner.x, 0.0f, 1.0f),
                                      std::clamp(corner.y, 0.0f, 1.0f));
    }
  }
  return topology;
}

/// Coverage by dense sub-sampling: per (chart = triangle, texel) the covered area.
std::map<std::pair<int32_t, int32_t>, double> sampled_cover(const MapTopology& topology,
                                                            int32_t samples) {
  std::map<std::pair<int32_t, int32_t>, double> cover;
  const auto size = static_cast<double>(topology.resolution);
  for (size_t t = 0; t < topology.triangles.size() / 3; ++t) {
    glm::dvec2 p[3];
    for (int k = 0; k < 3; ++k) p[k] = glm::dvec2(topology.corner_uv[3 * t + k]) * size;
    const auto side = [](glm::dvec2 a, glm::dvec2 b, glm::dvec2 q) {
      return (b.x - a.x) * (q.y - a.y) - (b.y - a.y) * (q.x - a.x);
    };
    const double winding = side(p[0], p[1], p[2]) < 0 ? -1.0 : 1.0;
    const double low_x = std::min({p[0].x, p[1].x, p[2].x}),
                 high_x = std::max({p[0].x, p[1].x, p[2].x});
    const double low_y = std::min({p[0].y, p[1].y, p[2].y}),
                 high_y = std::max({p[0].y, p[1].y, p[2].y});
    for (auto j = static_cast<int64_t>(low_y * samples);
         j <= static_cast<int64_t>(high_y * samples); ++j) {
      for (auto i = static_cast<int64_t>(low_x * samples);
           i <= static_cast<int64_t>(high_x * samples); ++i) {
        const glm::dvec2 q((static_cast<double>(i) + 0.5) / samples,
                           (static_cast<double>(j) + 0.5) / samples);
        bool inside = true;
        for (int k = 0; k < 3; ++k) inside = inside && winding * side(p[k], p[(k + 1) % 3], q) >= 0;
        if (!inside) continue;
        const auto texel = static_cast<int32_t>(j / samples * topology.resolution + i / samples);
        cover[{texel, static_cast<int32_t>(t)}] += 1.0 / (samples * samples);
      }
    }
  }
  return cover;
}

TEST(TexelTable, agreesWithDenseSamplingOnRandomTriangles) {
  for (uint32_t seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const MapTopology topology = random_triangles(seed, 40, 64);
    const TexelTable table = build_texel_table(topology);
    const auto cover = sampled_cover(topology, 32);
    std::map<int32_t, std::pair<int32_t, double>> expected_owner;
    for (const auto& [key, area] : cover) {
      auto& best = expected_owner[key.first];
      if (area > best.second) best = {key.second, area};
    }
    std::set<int32_t> owned(table.texel.begin(), table.texel.end());
    EXPECT_EQ(owned.size(), table.texel.size());
    EXPECT_TRUE(std::is_sorted(table.texel.begin(), table.texel.end()));
    int32_t disagreements = 0;
    for (size_t i = 0; i < table.texel.size(); ++i) {
      const auto sampled = cover.find({table.texel[i], table.chart[i]});
      const double area = sampled == cover.end() ? 0.0 : sampled->second;
      EXPECT_NEAR(table.coverage[i], area, 0.05) << "texel " << table.texel[i];
      const auto owner = expected_owner.find(table.texel[i]);
      if (owner != expected_owner.end() && owner->second.second > area + 0.05) ++disagreements;
    }
    // Only tiny charts that took a texel may own less than another covers.
    EXPECT_LE(disagreements, 10);
    for (const auto& [key, area] : cover) {
      if (area > 0.05) {
        EXPECT_TRUE(owned.count(key.first)) << "texel " << key.first;
      }
    }
    // Triangles that clamping to the map flattened have no shares.
    int32_t without_shares = 0;
    for (const double sum : share_sums(table, 40)) {
      if (sum == 0.0) {
        ++without_shares;
      } else {
        EXPECT_NEAR(sum, 1.0, 1e-5);
      }
    }
    EXPECT_EQ(without_shares, table.degenerate_triangles);
    EXPECT_LT(without_shares, 10);
  }
}

TEST(TexelTable, samplePointsLieInTheirTexelAndTriangle) {
  const MapTopology topology = random_triangles(11, 60, 128);
  const TexelTable table = build_texel_table(topology);
  for (size_t i = 0; i < table.texel.size(); ++i) {
    const glm::vec2 w = table.barycentric[i];
    EXPECT_GE(std::min({w.x, w.y, 1.0f - w.x - w.y}), -1e-6f);
    const glm::vec2* uv = topology.corner_uv.data() + 3 * table.triangle[i];
    const glm::vec2 p = 128.0f * (uv[0] * (1 - w.x - w.y) + uv[1] * w.x + uv[2] * w.y);
    const glm::vec2 corner(table.texel[i] % 128, table.texel[i] / 128);
    EXPECT_LE(std::max({corner.x - p.x, p.x - corner.x - 1, corner.y - p.y, p.y - corner.y - 1}),
              1e-3f);
  }
}

/// A grid of cells x cells quads over the map, in one chart, wavy inside.
MapTopology grid_map(int32_t cells, int32_t resolution) {
  MapTopology topology;
  topology.resolution = resolution;
  topology.vertex_count = (cells + 1) * (cells + 1);
  const auto uv = [&](int32_t i, int32_t j) {
    const float x = static_cast<float>(i) / cells, y = static_cast<float>(j) / cells;
    const bool rim = i == 0 || j == 0 || i == cells || j == cells;
    const float wave = rim ? 0.0f : 0.3f / cells;
    return glm::vec2(x + wave * std::sin(40 * y), y + wave * std::sin(37 * x));
  };
  for (int32_t j = 0; j < cells; ++j) {
    for (int32_t i = 0; i < cells; ++i) {
      const int32_t v = j * (cells + 1) + i;
      topology.triangles.insert(topology.triangles.end(),
                                {v, v + 1, v + cells + 2, v, v + cells + 2, v + cells + 1});
      topology.corner_uv.insert(
          topology.corner_uv.end(),
          {uv(i, j), uv(i + 1, j), uv(i + 1, j + 1), uv(i, j), uv(i + 1, j + 1), uv(i, j + 1)});
    }
  }
  return topology;
}

TEST(TexelTable, aHundredThousandTrianglesAreCutCompletely) {
  const MapTopology topology = grid_map(224, 1024);
  const auto start = std::chrono::steady_clock::now();
  const TexelTable table = build_texel_table(topology);
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
  std::printf("%zu triangles at 1024: %.0f ms\n", topology.triangles.size() / 3,
              1e3 * taken.count());
  EXPECT_EQ(table.texel.size(), 1024u * 1024u);
  EXPECT_EQ(table.chart_count, 1);
  EXPECT_LT(table.overlap, 1e-6f);
  double covered = 0.0;
  for (const float c : table.coverage) covered += c;
  EXPECT_NEAR(covered / (1024.0 * 1024.0), 1.0, 1e-6);
}

void expect_same(const TexelTable& a, const TexelTable& b) {
  EXPECT_EQ(a.texel, b.texel);
  EXPECT_EQ(a.triangle, b.triangle);
  EXPECT_EQ(a.barycentric, b.barycentric);
  EXPECT_EQ(a.chart, b.chart);
  EXPECT_EQ(a.coverage, b.coverage);
  EXPECT_EQ(a.fragment_begin, b.fragment_begin);
  EXPECT_EQ(a.fragment_triangle, b.fragment_triangle);
  EXPECT_EQ(a.fragment_share, b.fragment_share);
  EXPECT_EQ(a.degenerate_triangles, b.degenerate_triangles);
  EXPECT_EQ(a.unmapped_charts, b.unmapped_charts);
  EXPECT_EQ(a.overlap, b.overlap);
}

TEST(TexelTable, theSameInputGivesTheSameTable) {
  const MapTopology topology = random_triangles(5, 200, 256);
  expect_same(build_texel_table(topology), build_texel_table(topology));
}

TEST(TexelTable, doesNotDependOnTheNumberOfThreads) {
  const MapTopology topology = random_triangles(6, 300, 600);
  const TexelTable one = build_texel_table(topology, 1);
  for (const int32_t threads : {2, 5}) {
    SCOPED_TRACE(std::to_string(threads) + " threads");
    expect_same(one, build_texel_table(topology, threads));
  }
}

TEST(TexelTable, trianglesThatReachOverManyRowsKeepTheirArea) {
  const TexelTable table = build_texel_table(quad_map(0.1f, 0.0f, 0.9f, 1.0f, 1024), 2);
  for (const double sum : share_sums(table, 2)) EXPECT_NEAR(sum, 1.0, 1e-5);
  EXPECT_TRUE(std::is_sorted(table.texel.begin(), table.texel.end()));
  EXPECT_EQ(table.overlap, 0.0f);
}

TEST(TexelTable, texelsCoveredByTwoChartsGoToTheFirst) {
  MapTopology topology = quad_map(0, 0, 1, 1, 64);
  add_quad(topology, 0, 0, 1, 1);
  const TexelTable table = build_texel_table(topology);
  EXPECT_EQ(table.overlap, 1.0f);
  // The second chart takes one, so that it has a texel.
  EXPECT_EQ(std::count(table.chart.begin(), table.chart.end(), 1), 1);
  for (const double sum : share_sums(table, 4)) EXPECT_NEAR(sum, 1.0, 1e-5);
}

}  // namespace
}  // namespace snowbough::snow
