#include "snow/output/smoothing_kernels.h"

#include <gtest/gtest.h>

#include <array>

namespace snowbough::snow {
namespace {

TEST(SmoothingKernels, ALinkIsOpenBetweenSnowOfOneSideThatIsNotAFiftiethOfTheOther) {
  EXPECT_TRUE(is_open(0.1f, 0.1f));
  EXPECT_TRUE(is_open(-0.1f, -0.2f));
  EXPECT_TRUE(is_open(0.1f, 0.0021f));
  EXPECT_FALSE(is_open(0.1f, 0.0019f));
  EXPECT_FALSE(is_open(0.1f, -0.1f));
  EXPECT_FALSE(is_open(0.1f, 0.0f));
  EXPECT_FALSE(is_open(0.0f, 0.0f));
}

TEST(SmoothingKernels, AClosedLinkConductsNothing) {
  const ConductanceTerms terms{1.0f, 0.0f, kStages};
  const LinkConductance closed = conductance(0.1f, 0.0f, 1.0f, 1.0f, 1.0f, terms);
  EXPECT_EQ(closed.conductance, 0.0f);
  EXPECT_EQ(closed.wanted, 0.0f);
}

TEST(SmoothingKernels, AnOpenLinkConductsByTheThinnerEndAndNoMoreThanAFifthAStage) {
  // Half the square of a third of the depth is wanted at a distance of 1 m.
  const ConductanceTerms terms{0.0f, 0.0f, kStages};
  const LinkConductance thin = conductance(0.3f, 0.6f, 1.0f, 1.0f, 1.0f, terms);
  EXPECT_FLOAT_EQ(thin.wanted, 0.5f * 0.1f * 0.1f);
  EXPECT_FLOAT_EQ(thin.conductance * kStages, thin.wanted);
  const LinkConductance close = conductance(0.3f, 0.6f, 1.0f, 1.0f, 1e6f, terms);
  EXPECT_FLOAT_EQ(close.conductance, kStageShare);
}

TEST(SmoothingKernels, WhatTheBlocksBelowSeeToIsLeftOut) {
  const ConductanceTerms terms{0.02f, 0.004f, kStages};
  EXPECT_FLOAT_EQ(conductance(0.1f, 0.1f, 1.0f, 1.0f, 1.0f, terms).conductance * kStages, 0.006f);
}

TEST(SmoothingKernels, AStageMovesWhatOneCellLosesToItsNeighbour) {
  // Rows of four cells: the middle one's, one above and one below that hold nothing.
  constexpr ptrdiff_t kSize = 4;
  const std::array<float, 12> from{0, 0, 0, 0, 0, 0.3f, 0.1f, 0, 0, 0, 0, 0};
  std::array<float, 12> to{};
  std::array<float, 12> right{}, above{}, inverse{};
  right[5] = 0.2f;
  inverse[5] = 1.0f;
  inverse[6] = 0.5f;  // twice the area
  stage_run(&from[0], &to[0], &right[0], &above[0], &inverse[0], kSize, 5, 7);
  EXPECT_FLOAT_EQ(to[5], 0.3f - 0.2f * 0.2f);
  EXPECT_FLOAT_EQ(to[6], 0.1f + 0.5f * 0.2f * 0.2f);
  EXPECT_FLOAT_EQ(to[5] + 2.0f * to[6], 0.3f + 2.0f * 0.1f);
}

TEST(SmoothingKernels, ACellFollowsItsBlocksMeanAndKeepsAPartOfWhatSetsItApart) {
  EXPECT_FLOAT_EQ(changed(0.3f, 0.2f, 0.1f, 1.0f), 0.15f);
  EXPECT_FLOAT_EQ(changed(0.3f, 0.2f, 0.1f, 0.0f), 0.1f);
  EXPECT_EQ(damping(0.3f, 0.0f, 0.0f, 0.0f), 1.0f);
  EXPECT_LT(damping(0.3f, 1e4f, 0.0f, 0.0f), 0.01f);
}

}  // namespace
}  // namespace snowbough::snow
