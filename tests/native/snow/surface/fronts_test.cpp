#include "snow/surface/fronts.h"

#include <gtest/gtest.h>

namespace snowbough::snow {
namespace {

/// The share of a front over a bevel in the shape of snow as high as that behind its rim.
float share_over_bevel(float bevel, float height) {
  Fronts fronts;
  fronts.front.resize(1);
  fronts.front[0].presence = 1.0f;
  fronts.front[0].bevel = bevel;
  return fronts.presence(0, {height, 0.0f, 0.0f}, {0.0f, 0.0f});
}

TEST(Fronts, StandWhereSnowIsThickerThanABevel) {
  EXPECT_EQ(share_over_bevel(0.01f, 0.003f), 0.0f);
  EXPECT_NEAR(share_over_bevel(0.01f, 0.0075f), 0.5f, 0.001f);
  EXPECT_EQ(share_over_bevel(0.01f, 0.012f), 1.0f);
  EXPECT_EQ(share_over_bevel(0.0f, 0.003f), 1.0f);
}

}  // namespace
}  // namespace snowbough::snow
