// What snow that holds together does to the limits of links.
#include <gtest/gtest.h>

#include <cmath>

#include "row_of_texels.h"
#include "shaders/lib/texel_repose.h"
#include "snow/repose/tile.h"

namespace snowbough::snow {
namespace {

TEST(ReposeCohesion, MakesSlopesSteeperTheThinnerTheLimb) {
  // A limb with a radius of 5 mm has a sum of curvatures of 200 / m.
  EXPECT_FLOAT_EQ(shared::held_slope(2.0f, 0.005f, 200.0f), 4.0f);
  EXPECT_FLOAT_EQ(shared::held_slope(2.0f, 0.005f, 2.0f), 2.02f);
  EXPECT_FLOAT_EQ(shared::held_slope(2.0f, 0.0f, 200.0f), 2.0f);
  // Not in hollows, and not beyond 82 degrees, unless the angle of repose is.
  EXPECT_FLOAT_EQ(shared::held_slope(2.0f, 0.005f, -200.0f), 2.0f);
  EXPECT_FLOAT_EQ(shared::held_slope(2.0f, 0.005f, 2000.0f), shared::kSteepestHeld);
  EXPECT_FLOAT_EQ(shared::held_slope(9.0f, 0.005f, 2000.0f), 9.0f);
}

TEST(ReposeCohesion, GivesLinksTheMeanCurvatureOfTheirEnds) {
  ReposeTiles tiles = row_of(3);
  tiles[0]->curvature[0] = 100.0f;
  tiles[0]->curvature[1] = 300.0f;
  set_up_tile_links(tiles, 0, 1, {1.0f / shared::kEven, 0.005f});
  EXPECT_FLOAT_EQ(tiles[0]->limit[0][0], 0.02f);
  EXPECT_FLOAT_EQ(tiles[0]->limit[0][1], 0.0175f);
}

TEST(ReposeCohesion, LetsSnowStandUprightOverAWallOnly) {
  ReposeTiles tiles = row_of(3);
  tiles[0]->kind[2] = kWall;
  tiles[0]->z[2] -= 0.05f;
  set_up_tile_links(tiles, 0, 1, {1.0f / shared::kEven, 0.005f});
  EXPECT_FLOAT_EQ(tiles[0]->limit[0][0], 0.01f);
  EXPECT_FLOAT_EQ(tiles[0]->limit[0][1], 0.015f);
}

}  // namespace
}  // namespace snowbough::snow
