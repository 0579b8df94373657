#include "snow/output/smoothing_kernels.h"

#include <gtest/gtest.h>

namespace snowbough::snow {
namespace {

TEST(SmoothingKernels, ALinkIsClosedBetweenFrontAndBackAndBelowAFiftieth) {
  EXPECT_TRUE(is_open(0.1f, 0.1f));
  EXPECT_TRUE(is_open(-0.1f, -0.2f));
  EXPECT_TRUE(is_open(0.1f, 0.0021f));
  EXPECT_FALSE(is_open(0.1f, 0.0019f));
  EXPECT_FALSE(is_open(0.1f, -0.1f));
  EXPECT_FALSE(is_open(0.1f, 0.0f));
  EXPECT_FALSE(is_open(0.0f, 0.0f));
}

}  // namespace
}  // namespace snowbough::snow
