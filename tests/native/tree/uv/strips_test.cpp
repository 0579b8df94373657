#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "native/tree/uv/limbs.h"
#include "tree/uv/strip_pieces.h"
#include "tree/uv/strip_rows.h"

namespace snowbough::tree {
namespace {

using test::LimbBuilder;
using test::Ring;

/// A limb of two rows and a child of two more that goes on from its end ring, with its sides
/// counted from the parent's second corner.
LimbBuilder limb_with_continuing_child() {
  LimbBuilder limbs;
  const int32_t parent = limbs.add_branch(-1);
  std::vector<Ring> rings;
  for (int i = 0; i < 5; ++i) {
    rings.push_back(limbs.add_ring({0, 0, i}, {0, 0, 1}, 1.0f));
  }
  limbs.add_row(parent, 0, rings[0], rings[1]);
  limbs.add_row(parent, 1, rings[1], rings[2]);
  const int32_t child = limbs.add_branch(parent);
  const auto turned = [](const Ring& r) { return Ring{r[1], r[2], r[3], r[0]}; };
  limbs.add_row(child, 0, turned(rings[2]), turned(rings[3]));
  limbs.add_row(child, 1, turned(rings[3]), turned(rings[4]));
  return limbs;
}

TEST(CollectStrips, AChildOutOfAHoleStartsAStripOfItsOwn) {
  LimbBuilder limbs;
  const int32_t parent = limbs.add_branch(-1);
  const Ring low = limbs.add_ring({0, 0, 0}, {0, 0, 1}, 1.0f);
  const Ring high = limbs.add_ring({0, 0, 1}, {0, 0, 1}, 1.0f);
  for (const int side : {1, 2, 3}) {
    limbs.add_wall(parent, 0, side, low, high);
  }
  const int32_t child = limbs.add_branch(parent);
  const Ring hole{low[0], low[1], high[1], high[0]};
  limbs.add_row(child, 0, hole, limbs.add_ring({3, 3, 0}, {1, 1, 0}, 0.5f));
  const auto strips = collect_strips(limbs.mesh, limbs.skeleton);
  ASSERT_EQ(strips.size(), 2u);
  EXPECT_TRUE(strips[0].rows[0].cells[0].empty());
  EXPECT_FALSE(strips[0].rows[0].cells[1].empty());
}

TEST(CollectStrips, RefusesOriginsThatContradictTheQuads) {
  LimbBuilder limbs = limb_with_continuing_child();
  limbs.mesh.origins[5].side = 0;
  EXPECT_THROW(collect_strips(limbs.mesh, limbs.skeleton), std::invalid_argument);
  limbs = limb_with_continuing_child();
  limbs.mesh.origins[5].branch = 2;
  EXPECT_THROW(collect_strips(limbs.mesh, limbs.skeleton), std::invalid_argument);
  limbs = limb_with_continuing_child();
  std::swap(limbs.mesh.origins[0].side, limbs.mesh.origins[1].side);
  EXPECT_THROW(collect_strips(limbs.mesh, limbs.skeleton), std::invalid_argument);
  limbs = limb_with_continuing_child();
  limbs.mesh.origins[5].row = 1 << 30;
  EXPECT_THROW(collect_strips(limbs.mesh, limbs.skeleton), std::invalid_argument);
  limbs = limb_with_continuing_child();
  limbs.mesh.origins.pop_back();
  EXPECT_THROW(collect_strips(limbs.mesh, limbs.skeleton), std::invalid_argument);
}

std::vector<StripPiece> cut(const Strip& strip, const std::vector<double>& row_lengths,
                            double max_length) {
  std::vector<StripPiece> pieces;
  cut_strip(strip, 0, row_lengths, max_length, pieces);
  return pieces;
}

TEST(CutStrip, CutsALongStripBesideTheJointRatherThanAtIt) {
  const LimbBuilder limbs = limb_with_continuing_child();
  const auto strips = collect_strips(limbs.mesh, limbs.skeleton);
  // The middle is the joint; half a unit beside it is as good.
  const auto pieces = cut(strips[0], {1.5, 0.5, 0.5, 1.5}, 3.0);
  ASSERT_EQ(pieces.size(), 2u);
  EXPECT_NE(pieces[0].last_row, 2);
  EXPECT_EQ(pieces[0].last_row, pieces[1].first_row);
}

TEST(CutStrip, CutsIntoAsFewPiecesAsNeeded) {
  LimbBuilder limbs;
  limbs.add_limb({0, 0, 0}, {0, 0, 20}, 1, 1, 20);
  const auto strips = collect_strips(limbs.mesh, limbs.skeleton);
  const auto pieces = cut(strips[0], std::vector<double>(20, 1.0), 7.0);
  ASSERT_EQ(pieces.size(), 3u);
  EXPECT_TRUE(pieces[0].has_root_cap);
  EXPECT_FALSE(pieces[0].has_tip_cap);
  EXPECT_TRUE(pieces[2].has_tip_cap);
  for (const StripPiece& piece : pieces) {
    EXPECT_LE(piece.last_row - piece.first_row, 7);
    EXPECT_GE(piece.last_row - piece.first_row, 6);
  }
}

TEST(CutStrip, FallsApartWhereChildrenLeaveOnAllSides) {
  LimbBuilder limbs;
  const int32_t parent = limbs.add_branch(-1);
  std::vector<Ring> rings;
  for (int i = 0; i < 4; ++i) {
    rings.push_back(limbs.add_ring({0, 0, i}, {0, 0, 1}, 1.0f));
  }
  limbs.add_row(parent, 0, rings[0], rings[1]);
  limbs.add_row(parent, 2, rings[2], rings[3]);
  const auto strips = collect_strips(limbs.mesh, limbs.skeleton);
  const auto pieces = cut(strips[0], {1, 1, 1}, 9.0);
  ASSERT_EQ(pieces.size(), 2u);
  EXPECT_EQ(pieces[0].last_row, 1);
  EXPECT_EQ(pieces[1].first_row, 2);
}

TEST(ChooseSeam, MovesTheSeamAwayFromWhereItWouldSplitTheChart) {
  // Row 1 has walls on sides 3 and 0 only, row 0 on side 3, row 2 on side 0: a seam at corner 0
  // would part them.
  LimbBuilder limbs;
  const int32_t parent = limbs.add_branch(-1);
  std::vector<Ring> rings;
  for (int i = 0; i < 4; ++i) {
    rings.push_back(limbs.add_ring({0, 0, i}, {0, 0, 1}, 1.0f));
  }
  limbs.add_wall(parent, 0, 3, rings[0], rings[1]);
  limbs.add_wall(parent, 1, 3, rings[1], rings[2]);
  limbs.add_wall(parent, 1, 0, rings[1], rings[2]);
  limbs.add_wall(parent, 2, 0, rings[2], rings[3]);
  const auto strips = collect_strips(limbs.mesh, limbs.skeleton);
  const auto pieces = cut(strips[0], {1, 1, 1}, 9.0);
  ASSERT_EQ(pieces.size(), 1u);
  EXPECT_NE(choose_seam(strips[0], pieces[0]), 0);
}

}  // namespace
}  // namespace snowbough::tree
