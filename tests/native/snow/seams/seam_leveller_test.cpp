#include "snow/seams/seam_leveller.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "native/snow/layouts.h"
#include "snow/seams/least_squares.h"
#include "snow/seams/seam_gradients.h"
#include "snow/seams/seam_samples.h"
#include "snow/texels/charts.h"

namespace snowbough::snow {
namespace {

using ::testing::ElementsAre;
using ::testing::FloatNear;
using ::testing::Pointwise;

constexpr int64_t kAnyWork = int64_t{1} << 40;

/// A row of the terms {source, weight}, which ascend; `none` fills it up.
SeamRow row(const std::vector<std::pair<int32_t, float>>& terms, int32_t none) {
  SeamRow made;
  made.source.fill(none);
  for (size_t t = 0; t < terms.size(); ++t) {
    made.source[t] = terms[t].first;
    made.weight[t] = terms[t].second;
  }
  return made;
}

struct Problem {
  std::vector<SeamRow> rows;
  int32_t unknowns;
  std::vector<float> wanted;

  /// What solve() is given.
  std::vector<float> values() const {
    std::vector<float> sums(static_cast<size_t>(unknowns), 0.0f);
    for (size_t r = 0; r < rows.size(); ++r) {
      for (int32_t t = 0; t < kSeamTerms && rows[r].source[t] < unknowns; ++t) {
        sums[rows[r].source[t]] += rows[r].weight[t] * wanted[r];
      }
    }
    return sums;
  }
};

/// Rows of two to four terms over a dozen unknowns and one source that is none.
Problem random_problem(uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> number(-1.0f, 1.0f);
  Problem problem{{}, 12, {}};
  for (int r = 0; r < 30; ++r) {
    std::vector<std::pair<int32_t, float>> terms;
    for (int32_t i = 0; i <= 12; ++i) {
      if (random() % 4 == 0 && terms.size() < 4) terms.emplace_back(i, number(random));
    }
    problem.rows.push_back(row(terms, 13));
    problem.wanted.push_back(number(random));
  }
  return problem;
}

/// The normal equations solved by Gaussian elimination.
std::vector<float> dense_solution(const Problem& problem, float damping) {
  const auto n = static_cast<size_t>(problem.unknowns);
  std::vector<std::vector<double>> a(n, std::vector<double>(n + 1, 0.0));
  const std::vector<float> values = problem.values();
  for (size_t i = 0; i < n; ++i) {
    a[i][i] = damping;
    a[i][n] = values[i];
  }
  for (const SeamRow& r : problem.rows) {
    for (int32_t s = 0; s < kSeamTerms && r.source[s] < problem.unknowns; ++s) {
      for (int32_t t = 0; t < kSeamTerms && r.source[t] < problem.unknowns; ++t) {
        a[r.source[s]][r.source[t]] += static_cast<double>(r.weight[s]) * r.weight[t];
      }
    }
  }
  for (size_t k = 0; k < n; ++k) {
    for (size_t i = 0; i < n; ++i) {
      if (i == k) continue;
      const double part = a[i][k] / a[k][k];
      for (size_t j = k; j <= n; ++j) a[i][j] -= part * a[k][j];
    }
  }
  std::vector<float> solution;
  for (size_t i = 0; i < n; ++i) solution.push_back(static_cast<float>(a[i][n] / a[i][i]));
  return solution;
}

TEST(SeamFactor, findsWhatEliminationFinds) {
  for (uint32_t seed = 1; seed <= 5; ++seed) {
    const Problem problem = random_problem(seed);
    SeamFactor factor;
    ASSERT_TRUE(factor.compute(problem.rows, problem.unknowns, 0.1f, kAnyWork));
    std::vector<float> values = problem.values();
    factor.solve(values, 0.0f);
    EXPECT_THAT(values, Pointwise(FloatNear(1e-4f), dense_solution(problem, 0.1f)))
        << "seed " << seed;
  }
}

TEST(SeamFactor, dampingPullsTowardsZero) {
  SeamFactor factor;
  ASSERT_TRUE(factor.compute({row({{0, 1.0f}}, 1)}, 1, 0.5f, kAnyWork));
  std::vector<float> values{3.0f};
  factor.solve(values, 0.0f);
  EXPECT_FLOAT_EQ(values[0], 2.0f);
}

TEST(SeamFactor, refusesWhatTakesTooMuchWork) {
  const Problem problem = random_problem(1);
  SeamFactor factor;
  EXPECT_FALSE(factor.compute(problem.rows, problem.unknowns, 0.1f, 12));
  EXPECT_TRUE(factor.compute(problem.rows, problem.unknowns, 0.1f, 12 * 12 * 12));
}

TEST(SeamFactor, leavesOutWhatIsNegligible) {
  const std::vector<SeamRow> rows{row({{0, 1.0f}, {1, -1.0f}}, 4), row({{2, 1.0f}, {3, -1.0f}}, 4)};
  SeamFactor factor;
  ASSERT_TRUE(factor.compute(rows, 4, 1.0f, kAnyWork));
  std::vector<float> values{1e-3f, -1e-3f, 1.0f, -1.0f};
  factor.solve(values, 1e-2f);
  EXPECT_EQ(values[0], 0.0f);
  EXPECT_EQ(values[1], 0.0f);
  EXPECT_FLOAT_EQ(values[2], 1.0f / 3.0f);
  EXPECT_FLOAT_EQ(values[3], -1.0f / 3.0f);
}

TEST(SeamFactor, knowsWhatHangsTogether) {
  const std::vector<SeamRow> rows{row({{0, 1.0f}, {2, 1.0f}}, 5), row({{1, 1.0f}, {4, 1.0f}}, 5),
                                  row({{3, 1.0f}}, 5), row({{0, 1.0f}, {2, -1.0f}}, 5)};
  SeamFactor factor;
  ASSERT_TRUE(factor.compute(rows, 5, 1.0f, kAnyWork));
  EXPECT_THAT(factor.components(), ElementsAre(2, 4, 2, 3, 4));
}

TEST(SeamFactor, eliminatesAHubLast) {
  std::vector<SeamRow> rows;
  for (int32_t i = 1; i < 8; ++i) rows.push_back(row({{0, 1.0f}, {i, -1.0f}}, 8));
  std::vector<int32_t> order = SeamFactor::elimination_order(rows, 8);
  // Once one spoke is left it may come after the hub.
  EXPECT_GE(std::find(order.begin(), order.end(), 0) - order.begin(), 6);
  std::sort(order.begin(), order.end());
  EXPECT_THAT(order, ElementsAre(0, 1, 2, 3, 4, 5, 6, 7));
}

TEST(SeamGradients, comeNearTheFactorsSolution) {
  const Problem problem = random_problem(2);
  std::vector<float> values = problem.values();
  solve_by_gradients(problem.rows, 14, 0.1f, 24, values);
  EXPECT_THAT(values, Pointwise(FloatNear(1e-3f), dense_solution(problem, 0.1f)));
}

TEST(SeamGradients, leaveNothingToDoAtZero) {
  std::vector<float> values{0.0f, 0.0f};
  solve_by_gradients({row({{0, 1.0f}, {1, -1.0f}}, 2)}, 3, 0.1f, 5, values);
  EXPECT_THAT(values, ElementsAre(0.0f, 0.0f));
}

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

TEST(SeamGaps, everyPointIsTheOneSideLessTheOther) {
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

/// One point whose sides show texel 3 and texel 5 of a map of 8; the latter another chart's where
/// there is but one unknown.
SeamLevelling two_sides(int32_t unknowns) {
  return {{3, 5}, unknowns, {row({{0, -1.0f}, {1, 1.0f}}, 2)}, 1e-3f};
}

TEST(SeamLeveller, twoSidesMeetInTheMiddle) {
  std::vector<float> map{0.3f, 0.3f, 0.3f, 0.1f, 0.3f, 0.2f, 0.3f, 0.3f};
  SeamLeveller(two_sides(2)).run(map);
  EXPECT_NEAR(map[3], 0.15f, 1e-3f);
  EXPECT_NEAR(map[3], map[5], 0.005f * 0.15f);
  for (const int texel : {0, 1, 2, 4, 6, 7}) EXPECT_EQ(map[texel], 0.3f);
}

TEST(SeamLeveller, aTexelOfAnotherChartStaysAsItIs) {
  std::vector<float> map{0.0f, 0.0f, 0.0f, 0.1f, 0.0f, 0.2f, 0.0f, 0.0f};
  SeamLeveller(two_sides(1)).run(map);
  EXPECT_EQ(map[5], 0.2f);
  EXPECT_NEAR(map[3], 0.2f, 0.005f * 0.2f);
}

TEST(SeamLeveller, noSnowStaysNoSnow) {
  std::vector<float> map(8, 0.0f);
  SeamLeveller(two_sides(2)).run(map);
  EXPECT_THAT(map, testing::Each(0.0f));
}

TEST(SeamLeveller, snowThatOneSideAloneHasIsSharedOut) {
  std::vector<float> map(8, 0.0f);
  map[5] = 0.2f;
  SeamLeveller(two_sides(2)).run(map);
  EXPECT_NEAR(map[3], 0.1f, 2e-3f);
  EXPECT_NEAR(map[5], 0.1f, 2e-3f);
}

/// Sides that only a texel below 0 could make even: another chart's show 1 and 3 where one side is
/// 0.5 a + 0.5 b, the other 0.1 a + 0.9 b; b = 3.5 and a = -1.5 would do.
TEST(SeamLeveller, staysBetweenNothingAndTheHighestAround) {
  const SeamLevelling levelling{
      {0, 1, 2, 3},
      2,
      {row({{0, 0.5f}, {1, 0.5f}, {2, -1.0f}}, 4), row({{0, 0.1f}, {1, 0.9f}, {3, -1.0f}}, 4)},
      1e-3f};
  std::vector<float> map{2.0f, 2.0f, 1.0f, 3.0f};
  SeamLeveller(levelling).run(map);
  EXPECT_GE(map[0], 0.0f);
  EXPECT_LE(map[1], 3.0f);
  // With a at 0, b is between 2, which the one side wants, and 3, for the other.
  EXPECT_NEAR(map[0], 0.0f, 0.05f);
  EXPECT_GT(map[1], 2.0f);
}

TEST(SeamLeveller, countsWhatItKeeps) {
  SeamLeveller leveller(two_sides(2));
  EXPECT_GT(leveller.bytes(), static_cast<int64_t>(sizeof(SeamRow)));
  EXPECT_LT(leveller.bytes(), 1024);
}

}  // namespace
}  // namespace snowbough::snow
