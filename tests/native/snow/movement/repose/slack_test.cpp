#include "snow/movement/repose/slack.h"

#include <gtest/gtest.h>

#include <vector>

#include "shaders/lib/texel_repose.h"
#include "snow/movement/repose/repose.h"
#include "tests/native/snow/movement/repose/squares.h"

namespace snowbough::snow {
namespace {

constexpr ReposeLimits kOneToOne{1.0f / shared::kEven, 0.0f};

BlockSlack slack_of(const SceneObject& object, int32_t block) {
  ReposeSurface surface;
  surface.set_pose(object, *object.table, object.positions, false);
  const ReposeLinks links =
      find_repose_links(object.description.topology, *object.table, object.positions);
  return find_slack(surface, links, object.table->texel, block, kOneToOne);
}

TEST(BlockSlack, IsATexelOnLevelGroundAndHalfATexelAtAnOpenEdge) {
  const BlockSlack slack = slack_of(squares({}), 0);
  EXPECT_NEAR(slack.inside, 1.0f / 32.0f, 1e-5f);
  EXPECT_NEAR(slack.at_edges, 1.0f / 64.0f, 1e-5f);
  EXPECT_FLOAT_EQ(slack.column, 1.0f);
  EXPECT_NEAR(slack.turn, 0.0f, 1e-6f);
  EXPECT_EQ(slack.side, 1.0f);
  EXPECT_TRUE(slack.is_level(0.015f, 0.03f));
  EXPECT_FALSE(slack.is_level(0.015f, 0.032f));
  EXPECT_FALSE(slack.is_level(0.016f, 0.0f));
}

TEST(BlockSlack, IsSmallerOnASlope) {
  SceneObject object = squares({});
  // Falls by half a metre over a metre.
  for (const size_t corner : {2, 3}) object.positions[corner].z = 0.5f;
  EXPECT_NEAR(slack_of(object, 0).inside, (1.0f - 0.5f) / 32.0f, 1e-5f);
  for (const size_t corner : {2, 3}) object.positions[corner].z = 1.1f;
  EXPECT_LT(slack_of(object, 0).inside, 0.0f);
}

TEST(BlockSlack, IncludesLinksAcrossSeams) {
  EXPECT_NEAR(slack_of(squares({{2, 0, 0}, {2, 1, 0}}), 0).inside, 1.0f / 32.0f, 1e-5f);
  const BlockSlack beside_a_drop = slack_of(squares({{1.1f, 0, -2}, {1.1f, 1, -2}}), 0);
  EXPECT_LT(beside_a_drop.inside, 0.0f);
  // The slope itself is too steep as well.
  EXPECT_LT(slack_of(squares({{1.5f, 0, -2}, {1.5f, 1, -2}}), 1).inside, 0.0f);
}

TEST(BlockSlack, IsThatOfTheUpperSideOfASheetTurnedOver) {
  SceneObject object = squares({});
  for (glm::vec3& position : object.positions) position.x = -position.x;
  EXPECT_LT(slack_of(object, 0).inside, 0.0f);
  object.two_sided.assign(2, 1);
  const BlockSlack slack = slack_of(object, 0);
  EXPECT_EQ(slack.side, -1.0f);
  EXPECT_NEAR(slack.inside, 1.0f / 32.0f, 1e-5f);
}

TEST(Repose, SetsUpNoBlockWhereSnowRests) {
  const SceneObject object = squares({});
  ReposeLinkTables tables;
  Repose repose(object, tables);
  std::vector<float> height(64 * 64, 0.0f);
  for (const int32_t place : object.table->texel) height[static_cast<size_t>(place)] = 0.01f;
  EXPECT_EQ(repose.choose_blocks(height, kOneToOne), 0u);
  height[16 * 64 + 16] = 0.1f;
  EXPECT_EQ(repose.choose_blocks(height, kOneToOne), 1u);
  // Snow on the side that faces down falls.
  height.assign(64 * 64, 0.0f);
  for (const int32_t place : object.table->texel) height[static_cast<size_t>(place)] = -0.01f;
  EXPECT_EQ(repose.choose_blocks(height, kOneToOne), 1u);
}

}  // namespace
}  // namespace snowbough::snow
