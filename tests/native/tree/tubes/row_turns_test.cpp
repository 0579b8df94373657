#include "tree/tubes/row_turns.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "native/tree/built_surface.h"

namespace snowbough::tree {
namespace {

double turn_of(const Skeleton& skeleton) {
  const Built built = build(skeleton);
  const std::vector<int32_t> parents(skeleton.branches.size(), -1);
  const LimbShape shape =
      limb_shapes(built.surface, built.paths, parents, 5e-4 * built.scale.height).front();
  double sum = 0.0;
  for (size_t row = 0; row < shape.row_count(); ++row) sum += row_turns(shape, row).total();
  return sum;
}

TEST(RowTurns, AStraightLimbDoesNotTurn) {
  EXPECT_NEAR(turn_of(make_skeleton({trunk()})), 0.0, 1e-6);
}

TEST(RowTurns, ABentLimbTurnsByItsBends) {
  std::vector<glm::vec3> points;
  for (int i = 0; i <= 10; ++i) {
    const float angle = 0.1f * static_cast<float>(i);
    points.emplace_back(5.0f - 5.0f * std::cos(angle), 0.0f, 5.0f * std::sin(angle));
  }
  const std::vector<float> radii(points.size(), 0.1f);
  // Nine joints of a tenth.
  EXPECT_NEAR(turn_of(make_skeleton({make_branch(-1, 0, points, radii)})), 0.9, 0.2);
}

TEST(SpreadPieces, LieEvenlyWhereAsMuchIsWantedEverywhere) {
  const std::vector<double> at = spread_pieces({{0.0, 0.5, 1.0}, {2.0, 2.0}}, 4);
  ASSERT_EQ(at.size(), 5U);
  for (int i = 0; i <= 4; ++i) EXPECT_NEAR(at[i], 0.25 * i, 1e-6);
}

TEST(SpreadPieces, LieWhereMoreIsWanted) {
  const std::vector<double> at = spread_pieces({{0.0, 0.1, 1.0}, {9.0, 1.0}}, 10);
  ASSERT_EQ(at.size(), 11U);
  EXPECT_TRUE(std::is_sorted(at.begin(), at.end()));
  EXPECT_EQ(at.front(), 0.0);
  EXPECT_EQ(at.back(), 1.0);
  EXPECT_GE(std::count_if(at.begin(), at.end(), [](double t) { return t <= 0.1; }), 7);
}

}  // namespace
}  // namespace snowbough::tree
