#include "tree/tubes/side_counts.h"

#include <gtest/gtest.h>

#include "native/tree/built_surface.h"

namespace snowbough::tree {
namespace {

TEST(SideCounts, ArePowersOfTwoThatAreNearlyEnough) {
  EXPECT_EQ(power_of_two_from(0.3, 8), 1);
  EXPECT_EQ(power_of_two_from(2.2, 8), 2) << "a tenth more is not worth twice as many";
  EXPECT_EQ(power_of_two_from(2.4, 8), 4);
  EXPECT_EQ(power_of_two_from(100.0, 8), 8);
}

TEST(SideCounts, AThinLimbHasFourSidesAndAThickOneSixteen) {
  const Built built = build(make_skeleton({trunk(0.2f), side_branch(5.5f, 0.004f)}));
  const SideCounts across = count_sides(built.surface, LimbHoles(built.surface), built.scale.height,
                                        16, 1.5e-4 * built.scale.height);
  EXPECT_EQ(across[0].front(), 4);
  EXPECT_EQ(across[1].back(), 1);
}

TEST(SideCounts, AKnuckleHasAsManySidesAtBothEnds) {
  Branch tapering = trunk();
  for (size_t i = 0; i < tapering.radii.size(); ++i) {
    tapering.radii[i] = 0.2f - 0.019f * static_cast<float>(i);
    tapering.areas[i] = static_cast<float>(M_PI) * tapering.radii[i] * tapering.radii[i];
  }
  for (float height = 1.5f; height < 9.0f; height += 0.5f) {
    const Built built = build(make_skeleton({tapering, side_branch(height, 0.01f)}));
    const SideCounts across = count_sides(built.surface, LimbHoles(built.surface),
                                          built.scale.height, 16, 1.5e-4 * built.scale.height);
    const int32_t row = built.surface.junctions.front().row;
    EXPECT_EQ(across[0][row], across[0][row + 1]) << height;
  }
}

TEST(LimbHoles, NameTheChildrenOfARowInTheirOrder) {
  const Built built = build(whorl(4));
  const LimbHoles holes(built.surface);
  EXPECT_FALSE(holes.has_hole(0));
  EXPECT_TRUE(holes.has_hole(1));
  ASSERT_EQ(holes.leaving[0].size(), 4U);
  const Junction& second = built.surface.junctions[holes.leaving[0][1]];
  EXPECT_EQ(*holes.first_leaving(0, second.row, second.side), holes.leaving[0][1]);
  EXPECT_EQ(holes.first_leaving(0, 1000, 0), holes.leaving[0].end());
}

}  // namespace
}  // namespace snowbough::tree
