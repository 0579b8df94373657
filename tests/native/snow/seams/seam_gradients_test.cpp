#include "snow/seams/seam_gradients.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "native/snow/seams/problems.h"

namespace snowbough::snow {
namespace {

using ::testing::ElementsAre;
using ::testing::FloatNear;
using ::testing::Pointwise;

TEST(SeamGradients, comeNearTheFactorsSolution) {
  const Problem problem = random_problem(2);
  std::vector<float> values = problem.values();
  solve_by_gradients(problem.rows, 14, 0.1f, 24, values);
  EXPECT_THAT(values, Pointwise(FloatNear(1e-3f), dense_solution(problem, 0.1f)));
}

TEST(SeamGradients, leaveAnExactSolutionUnchanged) {
  std::vector<float> values{0.0f, 0.0f};
  solve_by_gradients({row({{0, 1.0f}, {1, -1.0f}}, 2)}, 3, 0.1f, 5, values);
  EXPECT_THAT(values, ElementsAre(0.0f, 0.0f));
}

}  // namespace
}  // namespace snowbough::snow
