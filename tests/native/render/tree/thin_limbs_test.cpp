#include "shaders/lib/thin_limbs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace snowbough::shared {
namespace {

TEST(ThinLimbs, theMeanAreaStaysAtEveryShare) {
  for (const float share : {0.01f, 0.1f, 0.5f, 0.8f, 0.95f, 1.0f}) {
    double sum = 0.0;
    constexpr int kNumbers = 100000;
    for (int i = 0; i < kNumbers; ++i) {
      sum += area_factor(share, (static_cast<float>(i) + 0.5f) / kNumbers);
    }
    EXPECT_NEAR(sum / kNumbers, 1.0, 1e-3) << share;
  }
}

TEST(ThinLimbs, allAreDrawnUnchangedAtAShareOfOne) {
  EXPECT_FLOAT_EQ(area_factor(1.0f, 0.0f), 1.0f);
  EXPECT_FLOAT_EQ(area_factor(1.0f, 0.999f), 1.0f);
}

TEST(ThinLimbs, aPatchFadesOutBeforeItIsDropped) {
  float last = area_factor(0.5f, 0.3f);
  EXPECT_GT(last, 1.0f);
  bool fades = false;
  for (float share = 0.3f; share > 0.2f; share -= 0.002f) {
    const float now = area_factor(share, 0.3f);
    EXPECT_LT(last - now, 0.5f) << share;
    fades = fades || (now > 0.0f && now < 1.0f);
    last = now;
  }
  EXPECT_TRUE(fades);
  EXPECT_EQ(last, 0.0f);
}

TEST(ThinLimbs, successivePatchesHaveNumbersFarApart) {
  for (int i = 0; i < 1000; ++i) {
    const float gap = std::abs(patch_number(i + 1) - patch_number(i));
    EXPECT_GT(std::min(gap, 1.0f - gap), 0.3f) << i;
  }
}

TEST(ThinLimbs, onlyPatchesBelowTheLeastSizeAreThinned) {
  EXPECT_FLOAT_EQ(drawn_share(0.35f, 0.7f), 0.5f);
  EXPECT_FLOAT_EQ(drawn_share(0.8f, 0.7f), 1.0f);
  EXPECT_FLOAT_EQ(drawn_share(0.0f, 0.0f), 1.0f);
}

}  // namespace
}  // namespace snowbough::shared
