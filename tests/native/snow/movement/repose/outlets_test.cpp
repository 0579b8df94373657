// How high snow can lie over open edges and walls, in a tile and the one beside it.
#include <gtest/gtest.h>

#include <cmath>

#include "row_of_texels.h"
#include "snow/movement/repose/tiles_around.h"

namespace snowbough::snow {
namespace {

TEST(ReposeOutlets, CutALidOverAnOpenEdgeToASlopeAtOnce) {
  ReposeTiles tiles = row_of(32);
  cover(tiles, std::vector<float>(32, 0.2f));
  lower_tile_bounds(tiles, 0, 1, outlet_links_of(tiles));
  EXPECT_TRUE(tiles[0]->cut());
  for (size_t i = 0; i < 32; ++i) {
    const float slope = shared::kCuts * 0.01f * (static_cast<float>(i) + 0.5f);
    EXPECT_NEAR(tiles[0]->snow.top[i], 0.1f + std::min(slope, 0.2f), 1.1e-5f) << i;
  }
  EXPECT_EQ(all_moved(*tiles[0]), std::floor(all_moved(*tiles[0])));
  // The rounds have nothing left to move.
  std::vector<OutletLink> outlet_links = outlet_links_of(tiles);
  EXPECT_FALSE(run_tile_rounds(tiles, 0, 1, outlet_links, 0, 1).has_changed);
}

TEST(ReposeOutlets, BoundSnowByItsDistanceWhereNoLinkLeadsStraightToTheOpenEdge) {
  ReposeTiles tiles = row_of(0);
  ReposeTile& tile = *tiles[0];
  std::vector<OutletLink> outlet_links;
  // Each row lies half a texel further along: links up lead to the left or to the right.
  for (int32_t cell = 0; cell < kTileCells; ++cell) {
    const int32_t column = cell % kReposeBlock;
    const int32_t row = cell / kReposeBlock;
    const auto i = static_cast<size_t>(cell);
    tile.ground.x[i] = 0.01f * static_cast<float>(column) + 0.005f * static_cast<float>(row);
    tile.ground.y[i] = 0.01f * static_cast<float>(row);
    tile.ground.z[i] = 0.1f;
    tile.ground.normal_z[i] = tile.ground.up[i] = 1.0f;
    tile.ground.area[i] = 1e-4f;
    const bool is_right = column + 1 < kReposeBlock;
    const bool is_above = row + 1 < kReposeBlock;
    tile.ground.forward[i] =
        static_cast<uint8_t>((is_right ? 1 : 0) | (is_above ? 2 : 0) |
                             (is_right && is_above ? 4 : 0) | (column > 0 && is_above ? 8 : 0));
    if (row == 0)
      outlet_links.push_back({.cell = cell, .top = 0.1f, .limit = 0.005f, .rate = 1.0f});
  }
  cover(tiles, std::vector<float>(kTileCells, 0.6f));
  lower_tile_bounds(tiles, 0, 1, outlet_links);
  for (int32_t row = 0; row < kReposeBlock; ++row) {
    const float away = 0.01f * static_cast<float>(row) + 0.005f;
    const auto middle = static_cast<size_t>(row * kReposeBlock + 16);
    EXPECT_NEAR(tile.outlets.bound[middle], 0.1f + shared::kCuts * away, 0.006f * away) << row;
  }
}

TEST(ReposeOutlets, LeaveAHeapInlandToTheRounds) {
  ReposeTiles tiles = row_of(32);
  std::vector<float> heights(32, 0.0f);
  heights[20] = 0.8f;
  cover(tiles, heights);
  lower_tile_bounds(tiles, 0, 1, outlet_links_of(tiles));
  EXPECT_FALSE(tiles[0]->cut());
}

TEST(ReposeOutlets, BoundTheSnowOfTilesBeside) {
  ReposeTiles tiles = two_tiles(std::vector<float>(64, 0.6f));
  const TileBounds done = lower_tile_bounds(tiles, 0, 2, outlet_links_of(tiles));
  EXPECT_TRUE(done.has_changed);
  EXPECT_EQ(done.seen_by & TileWindow::seen_by(kReposeBlock, 1), 1u << 5);
  EXPECT_NEAR(tiles[1]->outlets.bound[0], 0.1f + shared::kCuts * 0.325f, 1e-5f);
  lower_tile_bounds(tiles, 1, 2, {});
  EXPECT_NEAR(tiles[1]->outlets.bound[31], 0.1f + shared::kCuts * 0.635f, 1e-5f);
}

TEST(ReposeOutlets, PassOnAgainWhatHasChangedOnly) {
  ReposeTiles tiles = two_tiles(std::vector<float>(64, 0.6f));
  for (size_t t : {0, 1}) EXPECT_EQ(tiles[t]->outlets.rows_to_pass, kAllWindowRows);
  tiles[1]->outlets.rows_to_pass = 0;
  lower_tile_bounds(tiles, 0, 2, outlet_links_of(tiles));
  EXPECT_EQ(tiles[0]->outlets.rows_to_pass, 0u);
  EXPECT_EQ(tiles[1]->outlets.rows_to_pass, 1u);
  lower_tile_bounds(tiles, 1, 2, {});
  EXPECT_NEAR(tiles[1]->outlets.bound[31], 0.1f + shared::kCuts * 0.635f, 1e-5f);
  EXPECT_EQ(tiles[1]->outlets.rows_to_pass, 0u);
}

TEST(ReposeTile, ForgetsWhatMovedInAStepAndItsFlows) {
  ReposeTiles tiles = row_of(32);
  std::vector<float> heights(32, 0.0f);
  heights[20] = 0.8f;
  cover(tiles, heights);
  std::vector<OutletLink> outlet_links;
  EXPECT_TRUE(run_tile_rounds(tiles, 0, 1, outlet_links, 0, 2).has_changed);
  EXPECT_EQ(tiles[0]->snow.moved_rows, 1u);
  EXPECT_LT(tiles[0]->snow.moved[20], 0.0);
  EXPECT_NE((*tiles[0]->links.flow)[0][20], 0.0f);
  tiles[0]->begin_step();
  EXPECT_FALSE(tiles[0]->snow.has_moved());
  EXPECT_EQ(tiles[0]->snow.moved, decltype(tiles[0]->snow.moved){});
  EXPECT_EQ((*tiles[0]->links.flow)[0], TilePlane{});
}

TEST(TileWindow, SaysWhichTilesSeeACell) {
  EXPECT_EQ(TileWindow::seen_by(5, 5), 0u);
  EXPECT_EQ(TileWindow::seen_by(31, 5), 1u << 5);
  EXPECT_EQ(TileWindow::seen_by(-1, 5), 1u << 3);
  // Links lead upwards, so only tiles below look at the lowest row.
  EXPECT_EQ(TileWindow::seen_by(5, 0), 1u << 1);
  EXPECT_EQ(TileWindow::seen_by(5, 31), 0u);
  EXPECT_EQ(TileWindow::seen_by(5, 32), 1u << 7);
  EXPECT_EQ(TileWindow::seen_by(0, 0), 1u << 0 | 1u << 1 | 1u << 3);
}

}  // namespace
}  // namespace snowbough::snow
