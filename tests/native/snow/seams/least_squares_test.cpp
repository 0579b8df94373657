#include "snow/seams/least_squares.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "native/snow/seams/problems.h"

namespace snowbough::snow {
namespace {

using ::testing::ElementsAre;
using ::testing::FloatNear;
using ::testing::Pointwise;

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

TEST(SeamFactor, keepsAPartOfTheProblemToTheBit) {
  const Problem problem = random_problem(3);
  const std::vector<int32_t> kept{1, 2, 5, 6, 7, 10};
  std::vector<int32_t> number(static_cast<size_t>(problem.unknowns) + 1, -1);
  for (size_t k = 0; k < kept.size(); ++k) number[kept[k]] = static_cast<int32_t>(k);
  std::vector<SeamRow> rows;
  for (const SeamRow& whole : problem.rows) {
    SeamRow part;
    part.source.fill(static_cast<int32_t>(kept.size()));
    size_t count = 0;
    for (size_t t = 0; t < kSeamTerms && whole.source[t] < problem.unknowns; ++t) {
      if (number[whole.source[t]] < 0) continue;
      part.source[count] = number[whole.source[t]];
      part.weight[count++] = whole.weight[t];
    }
    if (count > 0) rows.push_back(part);
  }
  SeamFactor part;
  SeamFactor whole;
  const auto size = static_cast<int32_t>(kept.size());
  ASSERT_TRUE(part.compute(rows, size, 0.1f, kAnyWork));
  ASSERT_TRUE(whole.compute(problem.rows, problem.unknowns, 0.1f, kAnyWork));
  ASSERT_TRUE(whole.keep(kept));
  std::vector<float> expected{1.0f, -2.0f, 0.5f, 3.0f, 0.25f, -1.0f};
  std::vector<float> values = expected;
  part.solve(expected, 0.0f);
  whole.solve(values, 0.0f);
  EXPECT_EQ(values, expected);
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

}  // namespace
}  // namespace snowbough::snow
