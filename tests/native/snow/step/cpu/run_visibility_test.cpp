#include "snow/step/cpu/run_visibility.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace snowbough::snow {
namespace {

using cpu::RunVisibility;

/// A tile of 32 x 32 pixels, its lower left one local pixel (100, 200), that shows a level surface.
struct Shown {
  Tile tile{{{100, 200}, {132, 232}}, {0, 0}};
  std::vector<shared::SeenPixel> seen;

  explicit Shown(float depth) : seen(34 * 34 + cpu::kSeenSpare, {1, depth}) {}
  shared::SeenPixel& at(int32_t x, int32_t y) {
    return seen[static_cast<size_t>((y - 199) * 34 + x - 99)];
  }
};

/// Samples of a level surface 5 m deep between two local pixels.
cpu::RunPlane level(float low_x, float low_y, float high_x, float high_y) {
  cpu::RunPlane run{};
  run.corner = {low_x, low_y, 5.0f};
  run.edge_b = {high_x - low_x, 0.0f, 0.0f};
  run.edge_c = {0.0f, high_y - low_y, 0.0f};
  run.depth_bias = 0.001f;
  run.reach = 0.01f;
  run.most_b = run.most_c = 1.0f;
  run.most_sum = 2.0f;
  return run;
}

TEST(RunSight, AnOpenRunSeesAllOfTheSky) {
  Shown shown(5.0f);
  const cpu::RunPlane run = level(110.6f, 210.6f, 120.0f, 220.0f);
  EXPECT_EQ(visibility_of(run, shown.tile, shown.seen.data()), RunVisibility::kOpen);
  // The pixels around its samples are (110, 210) to (120, 220).
  shown.at(109, 215).depth = 1.0f;
  shown.at(121, 215).depth = 1.0f;
  shown.at(115, 221).depth = 1.0f;
  EXPECT_EQ(visibility_of(run, shown.tile, shown.seen.data()), RunVisibility::kOpen);
  shown.at(120, 220).depth = 4.9995f;
  EXPECT_EQ(visibility_of(run, shown.tile, shown.seen.data()), RunVisibility::kOpen);
  shown.at(120, 220).depth = 4.998f;
  EXPECT_EQ(visibility_of(run, shown.tile, shown.seen.data()), RunVisibility::kMixed);
}

TEST(RunSight, IsUndecidedNearAnEdge) {
  Shown shown(4.999f);
  EXPECT_EQ(visibility_of(level(110.5f, 210.5f, 120.0f, 220.0f), shown.tile, shown.seen.data()),
            RunVisibility::kMixed);
}

TEST(RunSight, AHiddenRunSeesNothing) {
  Shown shown(4.9f);
  const cpu::RunPlane run = level(110.5f, 210.5f, 120.0f, 220.0f);
  EXPECT_EQ(visibility_of(run, shown.tile, shown.seen.data()), RunVisibility::kHidden);
  // So near that it may be the surface itself.
  shown.at(112, 213).depth = 4.995f;
  EXPECT_EQ(visibility_of(run, shown.tile, shown.seen.data()), RunVisibility::kMixed);
}

TEST(RunSight, FollowsASlope) {
  Shown shown(5.0f);
  for (int32_t y = 199; y < 233; ++y) {
    for (int32_t x = 99; x < 133; ++x) {
      shown.at(x, y).depth = 5.0f + 0.25f * (static_cast<float>(x) + 0.5f - 110.5f);
    }
  }
  cpu::RunPlane run = level(110.5f, 210.5f, 120.0f, 220.0f);
  run.edge_b.z = 0.25f * 9.5f;
  run.gradient.x = 0.25f;
  EXPECT_EQ(visibility_of(run, shown.tile, shown.seen.data()), RunVisibility::kOpen);
  // A plane that does not contain its own samples decides nothing.
  run.gradient.x = 0.0f;
  EXPECT_EQ(visibility_of(run, shown.tile, shown.seen.data()), RunVisibility::kMixed);
}

TEST(RunSight, TellsWhichTileSamplesLieIn) {
  const Shown shown(5.0f);
  const auto visibility = [&](float low, float high) {
    return visibility_of(level(low, 210.0f, high, 212.0f), shown.tile, shown.seen.data());
  };
  EXPECT_EQ(visibility(90.0f, 99.9f), RunVisibility::kElsewhere);
  EXPECT_EQ(visibility(132.1f, 140.0f), RunVisibility::kElsewhere);
  EXPECT_EQ(visibility(99.0f, 101.0f), RunVisibility::kUnknown);
  EXPECT_EQ(visibility(131.0f, 133.0f), RunVisibility::kUnknown);
  EXPECT_EQ(visibility(100.1f, 131.9f), RunVisibility::kOpen);
}

TEST(RunSight, IsUndecidedForNotANumber) {
  const Shown shown(5.0f);
  cpu::RunPlane run = level(110.5f, 210.5f, 120.0f, 220.0f);
  run.edge_b.x = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(visibility_of(run, shown.tile, shown.seen.data()), RunVisibility::kUnknown);
  run.edge_b.x = std::numeric_limits<float>::infinity();
  EXPECT_EQ(visibility_of(run, shown.tile, shown.seen.data()), RunVisibility::kUnknown);
  run = level(110.5f, 210.5f, 120.0f, 220.0f);
  run.gradient.y = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(visibility_of(run, shown.tile, shown.seen.data()), RunVisibility::kMixed);
}

}  // namespace
}  // namespace snowbough::snow
