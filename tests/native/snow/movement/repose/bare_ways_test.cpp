// The ways down the bare surface: next_down and way_down.
#include <gtest/gtest.h>

#include "snow/movement/rays/map_point.h"
#include "snow/movement/repose/ground.h"
#include "tests/native/snow/movement/repose/squares.h"

namespace snowbough::snow {
namespace {

/// The first square falls by half a metre towards x = 1.
SceneObject tilted(SceneObject object) {
  for (const size_t corner : {1, 2}) object.positions[corner].z = -0.5f;
  return object;
}

class BareWays : public testing::Test {
 protected:
  void begin(SceneObject object) {
    object_ = std::move(object);
    ground_ = std::make_unique<ReposeGround>(object_, tables_, nullptr);
    update_ground(*ground_, false);
    bare_texels(*ground_);
    middle_ = texel_at(*object_.table, 16 * 64 + 16);
  }

  SceneObject object_;
  ReposeLinkTables tables_;
  std::unique_ptr<ReposeGround> ground_;
  int32_t middle_ = 0;
};

TEST_F(BareWays, LeadStraightDownOverTheOpenEdge) {
  begin(tilted(squares({})));
  EXPECT_EQ(next_down(*ground_, middle_), texel_at(*object_.table, 16 * 64 + 17));
  const Release end = way_down(*ground_, middle_);
  ASSERT_GE(end.outlet, 0);
  EXPECT_EQ(end.texel, texel_at(*object_.table, 16 * 64 + 31));
  const Outlet outlet = outlet_of(*ground_, {.number = end.outlet, .texel = end.texel});
  EXPECT_NEAR(outlet.point.x, 1.0, 1e-6);
  EXPECT_NEAR(outlet.outwards.x, 1.0, 1e-6);
}

TEST_F(BareWays, EndWhereTheyBeginOnLevelGround) {
  begin(squares({}));
  const Release end = way_down(*ground_, middle_);
  EXPECT_EQ(end.outlet, Release::kInHollow);
  EXPECT_EQ(end.texel, middle_);
}

TEST_F(BareWays, LeadAcrossASeam) {
  // Half a metre further down over the second square, whose far edge is the end.
  begin(tilted(squares_apart({{2, 0, -1}, {2, 1, -1}})));
  const Release end = way_down(*ground_, middle_);
  EXPECT_GE(end.outlet, 0);
  EXPECT_EQ(end.texel, texel_at(*object_.table, 48 * 64 + 63));
}

TEST_F(BareWays, EndAboveAWallBeyondASeam) {
  begin(tilted(squares_apart({{1, 0, -1.5f}, {1, 1, -1.5f}})));
  const Release end = way_down(*ground_, middle_);
  EXPECT_GE(end.outlet, 0);
  EXPECT_EQ(end.texel, texel_at(*object_.table, 16 * 64 + 31));
  EXPECT_EQ(next_down(*ground_, end.texel, true), texel_at(*object_.table, 48 * 64 + 32));
}

TEST_F(BareWays, EndOnAWallOfTheSameChart) {
  begin(tilted(squares({{1, 0, -1.5f}, {1, 1, -1.5f}})));
  const Release end = way_down(*ground_, middle_);
  EXPECT_EQ(end.outlet, Release::kOffWall);
  EXPECT_EQ(end.texel, texel_at(*object_.table, 16 * 64 + 32));
}

}  // namespace
}  // namespace snowbough::snow
