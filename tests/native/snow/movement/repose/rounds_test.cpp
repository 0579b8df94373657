// The arithmetic of repose on a few texels, and its rounds in one tile.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "row_of_texels.h"
#include "shaders/lib/texel_repose.h"
#include "snow/movement/repose/tile.h"

namespace snowbough::snow {
namespace {

TEST(ReposeFlow, StartsOverTheLimitAndComesToRestBelowIt) {
  EXPECT_EQ(shared::wanted_flow(0.0f, 1.00f, 1.0f, 1000.0f, 0.9f), 0.0f);
  EXPECT_NEAR(shared::wanted_flow(0.0f, 1.10f, 1.0f, 1000.0f, 0.9f), 140.0f, 0.1f);
  // Flowing snow keeps nine tenths of its flow.
  EXPECT_NEAR(shared::wanted_flow(100.0f, 0.96f, 1.0f, 1000.0f, 0.9f), 90.0f, 0.1f);
  EXPECT_EQ(shared::wanted_flow(100.0f, 0.91f, 1.0f, 1000.0f, 0.9f), 0.0f);
}

TEST(ReposeFlow, IsTheSameFromEitherEnd) {
  for (const float fall : {-2.0f, -1.2f, -0.3f, 0.7f, 1.3f, 5.0f}) {
    for (const float before : {-50.0f, 0.0f, 17.0f}) {
      const float there = shared::wanted_flow(before, fall, 1.0f, 333.3f, 0.7f);
      const float back = shared::wanted_flow(-before, -fall, 1.0f, 333.3f, 0.7f);
      EXPECT_EQ(there, -back);
      EXPECT_EQ(shared::given_flow(there, 0.3f, 0.6f), -shared::given_flow(back, 0.6f, 0.3f));
    }
  }
}

TEST(ReposeFlow, GivesNoMoreThanThereIsAndWholeUnits) {
  EXPECT_EQ(shared::given_part(10.0f, 40.0f), 0.25f);
  EXPECT_EQ(shared::given_part(10.0f, 4.0f), 1.0f);
  EXPECT_EQ(shared::given_flow(15.0f, 0.25f, 1.0f), 3.0f);
  EXPECT_EQ(shared::given_flow(-15.0f, 1.0f, 0.5f), -7.0f);
}

TEST(ReposeFlow, AllowsSoMuchFallAMetre) {
  EXPECT_FLOAT_EQ(shared::link_limit(0.01f, 2.0f / shared::kEven, 0.0f, 0.0f, 0.0f), 0.02f);
}

TEST(ReposeFlow, AllowsALinkDownTooSteepASurfaceItsPartOfASlope) {
  const float slope = 2.0f / shared::kEven;
  // On a surface with a slope of 3, at 45 degrees to the way straight down.
  const float part = std::sqrt(0.5f);
  EXPECT_FLOAT_EQ(shared::link_limit(0.01f, slope, 0.03f * part, 3.0f, 0.5f), 0.02f * part);
  EXPECT_FLOAT_EQ(shared::link_limit(0.01f, slope, -0.03f * part, 3.0f, 0.5f), 0.02f * part);
  // Neither on a surface on which snow rests, nor across the slope.
  EXPECT_FLOAT_EQ(shared::link_limit(0.01f, slope, 0.019f * part, 1.9f, 0.5f), 0.02f);
  EXPECT_FLOAT_EQ(shared::link_limit(0.01f, slope, 0.001f, 3.0f, 0.5f), 0.02f);
}

TEST(ReposeFlow, UsesColumnsThatHoldAsMuchAsSnowAlongTheNormal) {
  EXPECT_FLOAT_EQ(shared::column_height(1.0f), 1.0f);
  EXPECT_FLOAT_EQ(shared::column_height(0.5f), 2.0f);
  EXPECT_FLOAT_EQ(shared::column_height(-0.5f), 1.0f / shared::kWallUp);
}

TEST(ReposeFlow, PassesABoundOnWhereItCutsSnowOrNearly) {
  EXPECT_EQ(shared::passed_bound(0.3f, 0.4f, 0.1f), 0.3f);
  EXPECT_EQ(shared::passed_bound(0.3f, 0.27f, 0.1f), 0.3f);
  EXPECT_EQ(shared::passed_bound(0.3f, 0.25f, 0.1f), shared::kUnbounded);
  // Not below the bare surface.
  EXPECT_EQ(shared::passed_bound(0.05f, 0.1f, 0.1f), 0.1f);
}

TEST(ReposeSide, IsThatOfTheSnowOrOfABareSheetTheOneThatFacesUp) {
  EXPECT_EQ(shared::snow_side(0.1f, -1.0f, true), 1.0f);
  EXPECT_EQ(shared::snow_side(-0.1f, 1.0f, true), -1.0f);
  EXPECT_EQ(shared::snow_side(0.0f, -0.5f, true), -1.0f);
  EXPECT_EQ(shared::snow_side(0.0f, -0.5f, false), 1.0f);
  EXPECT_EQ(shared::snow_side(0.0f, 0.5f, true), 1.0f);
}

void run_to_rest(ReposeTiles& tiles, std::vector<OutletLink>& outlet_links) {
  TileRounds done;
  done.flows = true;
  for (int round = 0; done.flows && round < 1000; round += 10) {
    done = run_tile_rounds(tiles, 0, 1, outlet_links, round, 10);
  }
  EXPECT_FALSE(done.flows);
}

TEST(ReposeRounds, LeaveTwoTexelsAsTheyAreUpToTheLimit) {
  ReposeTiles tiles = row_of(2);
  cover(tiles, {0.0599f, 0.05f});
  std::vector<OutletLink> none;
  EXPECT_FALSE(run_tile_rounds(tiles, 0, 1, none, 0, 8).has_changed);
  EXPECT_EQ(tiles[0]->snow.moved[0], 0.0);
}

TEST(ReposeRounds, BringTwoTexelsToTheLimitAndLoseNothing) {
  ReposeTiles tiles = row_of(2);
  cover(tiles, {0.062f, 0.05f});
  std::vector<OutletLink> none;
  run_to_rest(tiles, none);
  const ReposeTile& tile = *tiles[0];
  EXPECT_EQ(tile.snow.moved[0] + tile.snow.moved[1], 0.0);
  EXPECT_LE(tile.snow.top[0] - tile.snow.top[1], 0.0100001f);
  EXPECT_GE(tile.snow.top[0] - tile.snow.top[1], 0.0085f);
  EXPECT_NEAR(tile.snow.top[0] + tile.snow.top[1], 0.312f, 1e-6f);
}

TEST(ReposeRounds, SpreadAHeapOverThreeTexelsAlikeOnBothSides) {
  ReposeTiles tiles = row_of(3);
  cover(tiles, {0.05f, 0.064f, 0.05f});
  std::vector<OutletLink> none;
  run_to_rest(tiles, none);
  const ReposeTile& tile = *tiles[0];
  EXPECT_EQ(all_moved(tile), 0.0);
  EXPECT_EQ(tile.snow.moved[0], tile.snow.moved[2]);
  EXPECT_LE(tile.snow.top[1] - tile.snow.top[0], 0.0100001f);
  EXPECT_GT(tile.snow.top[1] - tile.snow.top[0], 0.004f);
}

TEST(ReposeRounds, LetFallOverAnOpenEdgeWhatItDoesNotSupport) {
  ReposeTiles tiles = row_of(1);
  cover(tiles, {0.02f});
  // The open edge is half a texel away.
  std::vector<OutletLink> outlet_links = outlet_links_of(tiles);
  run_to_rest(tiles, outlet_links);
  EXPECT_LE(tiles[0]->snow.top[0] - 0.1f, 0.0050001f);
  EXPECT_GT(tiles[0]->snow.top[0] - 0.1f, 0.001f);
  EXPECT_LT(tiles[0]->snow.moved[0], 0.0);
  EXPECT_EQ(tiles[0]->snow.moved[0], std::floor(tiles[0]->snow.moved[0]));
}

TEST(ReposeRounds, MoveNothingOntoWallsWithoutAnOutlet) {
  for (const float wall_z : {0.0f, 0.2f}) {
    ReposeTiles tiles = row_of(2);
    tiles[0]->ground.z[1] = wall_z;
    tiles[0]->ground.up[1] = tiles[0]->ground.normal_z[1] = 0.05f;
    cover(tiles, {0.08f, 0.01f});
    std::vector<OutletLink> none;
    run_to_rest(tiles, none);
    EXPECT_EQ(tiles[0]->snow.moved[0], 0.0);
    EXPECT_EQ(tiles[0]->snow.moved[1], 0.0);
  }
}

TEST(ReposeRounds, EmptyWhatIsSteeperThanTheLimitWhenBare) {
  ReposeTiles tiles = row_of(3);
  for (size_t i = 0; i < 3; ++i) {
    tiles[0]->ground.z[i] = 0.1f - 0.02f * static_cast<float>(i);
    tiles[0]->ground.up[i] = tiles[0]->ground.normal_z[i] = 0.447f;
  }
  cover(tiles, {0.001f, 0.001f, 0.001f});
  std::vector<OutletLink> none;
  run_to_rest(tiles, none);
  EXPECT_NEAR(tiles[0]->snow.held[0] + tiles[0]->snow.moved[0], 0.0, 1.0);
  EXPECT_EQ(all_moved(*tiles[0]), 0.0);
}

TEST(ReposeRounds, LetATileSleepUntilSnowComesFromBeside) {
  std::vector<float> heights(64, 0.05f);
  heights[31] = 0.0645f;
  ReposeTiles tiles = two_tiles(heights);
  std::vector<OutletLink> none;
  EXPECT_FALSE(run_tile_rounds(tiles, 1, 2, none, 0, 8).has_changed);
  EXPECT_FALSE(tiles[1]->links.is_active());
  EXPECT_TRUE(run_tile_rounds(tiles, 0, 2, none, 0, 8).has_changed);
  EXPECT_GT(tiles[1]->snow.moved[0], 0.0);
  EXPECT_EQ(tiles[1]->links.active_rows.load(), 1u);  // its first row
  EXPECT_EQ(all_moved(*tiles[0]) + all_moved(*tiles[1]), 0.0);
}

TEST(ReposeRounds, DoNotAskABareSlopeForSnow) {
  ReposeTiles tiles = row_of(3);
  for (size_t i = 0; i < 3; ++i) tiles[0]->ground.z[i] = 0.1f - 0.02f * static_cast<float>(i);
  cover(tiles, {0.0f, 0.0f, 0.0f});
  std::vector<OutletLink> none;
  EXPECT_EQ(run_tile_rounds(tiles, 0, 1, none, 0, 8).rounds, 0);
  EXPECT_FALSE(tiles[0]->links.is_active());
}

TEST(ReposeRounds, CarryABankToRestInAFewRoundsATexel) {
  ReposeTiles tiles = row_of(32);
  std::vector<float> heights(32, 0.2f);
  std::fill(heights.begin() + 16, heights.end(), 0.0f);
  cover(tiles, heights);
  std::vector<OutletLink> none;
  int rounds = 0;
  while (run_tile_rounds(tiles, 0, 1, none, rounds, 1).flows && rounds < 1000) ++rounds;
  EXPECT_LT(rounds, 200);
  for (size_t i = 0; i + 1 < 32; ++i) {
    EXPECT_LE(std::abs(tiles[0]->snow.top[i] - tiles[0]->snow.top[i + 1]), 0.0100001f);
  }
  EXPECT_EQ(all_moved(*tiles[0]), 0.0);
}

}  // namespace
}  // namespace snowbough::snow
