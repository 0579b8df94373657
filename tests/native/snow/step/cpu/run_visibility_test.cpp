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
