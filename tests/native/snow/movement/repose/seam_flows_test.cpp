#include "snow/movement/repose/seam_flows.h"

#include <gtest/gtest.h>

#include <numeric>

#include "snow/movement/repose/repose.h"
#include "tests/native/snow/movement/repose/squares.h"

namespace snowbough::snow {
namespace {

TEST(SeamFlows, CarryAHeapAcross) {
  const SceneObject object = squares_apart({{2, 0, 0}, {2, 1, 0}});
  ReposeLinkTables tables;
  Repose repose(object, tables);
  std::vector<float> height(64 * 64, 0.0f);
  // Beside the seam, on the first square only.
  for (int32_t row = 14; row < 18; ++row) {
    for (int32_t column = 28; column < 32; ++column) height[row * 64 + column] = 0.2f;
  }
  const double before = std::accumulate(height.begin(), height.end(), 0.0);
  ASSERT_GT(repose.choose_blocks(height, {.slope = 1.0f}), 0u);
  repose.set_up(height, false);
  const double fallen = repose.run(height, 0.25f, false, false).fallen;
  EXPECT_EQ(fallen, 0.0);
  double across = 0.0;
  for (int32_t row = 32; row < 64; ++row) {
    for (int32_t column = 32; column < 64; ++column) across += height[row * 64 + column];
  }
  EXPECT_GT(across, 0.0);
  // At most as steep there as anywhere, between texels 1 / 32 m apart.
  const float steep = height[16 * 64 + 31] - height[48 * 64 + 32];
  EXPECT_GT(height[48 * 64 + 32], 0.0f);
  EXPECT_LE(steep, 1.0f / 32.0f);
  EXPECT_NEAR(std::accumulate(height.begin(), height.end(), 0.0), before, 1e-5 * before);
}

TEST(SeamFlows, NoteABlockAndItsNeighboursOnce) {
  ReposeLinks links;
  links.blocks_a_side = 3;
  SeamFlows flows;
  flows.is_noted.assign(9, 0);
  note_active(links, flows, 0);
  note_active(links, flows, 1);
  EXPECT_EQ(flows.noted, (std::vector<int32_t>{0, 1, 3, 4, 2, 5}));
}

}  // namespace
}  // namespace snowbough::snow
