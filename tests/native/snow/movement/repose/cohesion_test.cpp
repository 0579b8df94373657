// The limits of links in cohesive snow.
#include <gtest/gtest.h>

#include <cmath>

#include "row_of_texels.h"
#include "shaders/lib/texel_repose.h"
#include "snow/movement/repose/tile.h"

namespace snowbough::snow {
namespace {

TEST(ReposeCohesion, MakesSlopesSteeperOnTwigs) {
  // A limb with a radius of 5 mm has a sum of curvatures of 200 / m.
  EXPECT_FLOAT_EQ(shared::held_slope(2.0f, 0.005f, 200.0f), 4.0f);
  // One of 2 cm; and one of half a metre and a needle, where slopes hardly differ.
  EXPECT_FLOAT_EQ(shared::held_slope(2.0f, 0.005f, 50.0f), 2.0f * (1.0f + 0.5f / 1.0625f));
  EXPECT_NEAR(shared::held_slope(2.0f, 0.005f, 2.0f), 2.04f, 1e-4f);
  EXPECT_NEAR(shared::held_slope(2.0f, 0.005f, 4000.0f), 2.2f, 2e-3f);
  EXPECT_FLOAT_EQ(shared::held_slope(2.0f, 0.0f, 200.0f), 2.0f);
  // Cohesion does not count in hollows, nor beyond 82 degrees unless the angle of repose is larger.
  EXPECT_FLOAT_EQ(shared::held_slope(2.0f, 0.005f, -200.0f), 2.0f);
  EXPECT_FLOAT_EQ(shared::held_slope(6.0f, 0.005f, 200.0f), shared::kSteepestHeld);
  EXPECT_FLOAT_EQ(shared::held_slope(9.0f, 0.005f, 200.0f), 9.0f);
}

TEST(ReposeCohesion, GivesLinksTheMeanCurvatureOfTheirEnds) {
  ReposeTiles tiles = row_of(3);
  tiles[0]->ground.curvature[0] = 100.0f;
  tiles[0]->ground.curvature[1] = 300.0f;
  set_up_tile_links(tiles, 0, 1, {1.0f / shared::kEven, 0.005f});
  EXPECT_FLOAT_EQ(tiles[0]->links.limit[0][0], 0.02f);
  EXPECT_FLOAT_EQ(tiles[0]->links.limit[0][1], 0.0196f);
}

}  // namespace
}  // namespace snowbough::snow
