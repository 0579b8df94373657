#include "snow/seams/least_squares.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <numeric>

#include "native/snow/seams/problems.h"
#include "snow/seams/number_set.h"
#include "snow/seams/seam_pattern.h"

namespace snowbough::snow {
namespace {

using ::testing::ElementsAre;
using ::testing::FloatNear;
using ::testing::Pointwise;

/// A factor for these rows, in which all of them and the unknowns `in` are.
SeamFactor begun(const std::vector<SeamRow>& rows, int32_t unknowns, const std::vector<int32_t>& in,
                 float damping) {
  SeamFactor factor(std::make_shared<const SeamPattern>(rows, unknowns));
  factor.begin(in, damping);
  for (size_t r = 0; r < rows.size(); ++r) {
    SeamRow part = rows[r];
    for (size_t t = 0; t < kSeamTerms; ++t) {
      if (std::find(in.begin(), in.end(), part.source[t]) == in.end()) part.weight[t] = 0.0f;
    }
    factor.add(static_cast<int32_t>(r), part);
  }
  return factor;
}

SeamFactor begun(const std::vector<SeamRow>& rows, int32_t unknowns, float damping) {
  std::vector<int32_t> all(static_cast<size_t>(unknowns));
  std::iota(all.begin(), all.end(), 0);
  return begun(rows, unknowns, all, damping);
}

TEST(SeamFactor, findsWhatEliminationFinds) {
  for (uint32_t seed = 1; seed <= 5; ++seed) {
    const Problem problem = random_problem(seed);
    SeamFactor factor = begun(problem.rows, problem.unknowns, 0.1f);
    ASSERT_TRUE(factor.factorise(kAnyWork));
    std::vector<float> values = problem.values();
    factor.solve(values, 0.0f);
    EXPECT_THAT(values, Pointwise(FloatNear(1e-4f), dense_solution(problem, 0.1f)))
        << "seed " << seed;
  }
}

TEST(SeamFactor, leavesOthersAlone) {
  const Problem problem = random_problem(2);
  SeamFactor factor = begun(problem.rows, problem.unknowns, {2, 3, 7}, 0.1f);
  ASSERT_TRUE(factor.factorise(kAnyWork));
  std::vector<float> values(static_cast<size_t>(problem.unknowns), 0.0f);
  values[2] = values[3] = values[7] = 1.0f;
  values[5] = 42.0f;
  factor.solve(values, 0.0f);
  EXPECT_EQ(values[5], 42.0f);
  EXPECT_EQ(values[0], 0.0f);
}

TEST(SeamFactor, refusesWhatTakesTooMuchWork) {
  const Problem problem = random_problem(1);
  SeamFactor factor = begun(problem.rows, problem.unknowns, 0.1f);
  EXPECT_FALSE(factor.factorise(12));
  EXPECT_TRUE(factor.factorise(12 * 12 * 12));
}

TEST(SeamFactor, leavesOutWhatIsNegligible) {
  const std::vector<SeamRow> rows{row({{0, 1.0f}, {1, -1.0f}}, 4), row({{2, 1.0f}, {3, -1.0f}}, 4)};
  SeamFactor factor = begun(rows, 4, 1.0f);
  ASSERT_TRUE(factor.factorise(kAnyWork));
  std::vector<float> values{1e-3f, -1e-3f, 1.0f, -1.0f};
  factor.solve(values, 1e-2f);
  EXPECT_EQ(values[0], 0.0f);
  EXPECT_EQ(values[1], 0.0f);
  EXPECT_FLOAT_EQ(values[2], 1.0f / 3.0f);
  EXPECT_FLOAT_EQ(values[3], -1.0f / 3.0f);
}

TEST(SeamFactor, numbersItsComponents) {
  const std::vector<SeamRow> rows{row({{0, 1.0f}, {2, 1.0f}}, 5), row({{1, 1.0f}, {4, 1.0f}}, 5),
                                  row({{3, 1.0f}}, 5), row({{0, 1.0f}, {2, 0.5f}}, 5)};
  SeamFactor factor = begun(rows, 5, 1.0f);
  ASSERT_TRUE(factor.factorise(kAnyWork));
  EXPECT_THAT(factor.components(), ElementsAre(2, 4, 2, 3, 4));
}

TEST(SeamFactor, splitsComponentsWhereAnUnknownGoes) {
  const std::vector<SeamRow> rows{row({{0, 1.0f}, {1, 1.0f}}, 4), row({{1, 1.0f}, {2, 1.0f}}, 4),
                                  row({{2, 1.0f}, {3, 1.0f}}, 4)};
  SeamFactor factor = begun(rows, 4, 1.0f);
  ASSERT_TRUE(factor.factorise(kAnyWork));
  EXPECT_THAT(factor.components(), ElementsAre(3, 3, 3, 3));
  ASSERT_TRUE(factor.keep({0, 2, 3}));
  EXPECT_THAT(factor.components(), ElementsAre(0, 3, 3));
}

TEST(NumberSet, givesNumbersInOrderOnce) {
  NumberSet set;
  set.resize(200);
  for (const int32_t number : {130, 3, 63, 64, 3, 199}) set.add(number);
  std::vector<int32_t> numbers{7};
  set.take(numbers);
  EXPECT_THAT(numbers, ElementsAre(3, 63, 64, 130, 199));
  set.take(numbers);
  EXPECT_THAT(numbers, ElementsAre());
}

TEST(SeamFactor, eliminatesAHubLast) {
  std::vector<SeamRow> rows;
  for (int32_t i = 1; i < 8; ++i) rows.push_back(row({{0, 1.0f}, {i, -1.0f}}, 8));
  std::vector<int32_t> order = SeamFactor::elimination_order(rows, 8);
  // The last spoke may come after the hub.
  EXPECT_GE(std::find(order.begin(), order.end(), 0) - order.begin(), 6);
  std::sort(order.begin(), order.end());
  EXPECT_THAT(order, ElementsAre(0, 1, 2, 3, 4, 5, 6, 7));
}

}  // namespace
}  // namespace snowbough::snow
