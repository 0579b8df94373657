#include "snow/surface/volume_balance.h"

#include <gtest/gtest.h>

#include <cmath>

namespace snowbough::snow {
namespace {

/// 101 points a tenth of a metre apart along x.
std::vector<glm::vec3> row(float start = 0.0f) {
  std::vector<glm::vec3> points;
  for (int i = 0; i <= 100; ++i)
    points.emplace_back(start + 0.1f * static_cast<float>(i), 0.3f, 0.2f);
  return points;
}

TEST(VolumeBalance, TakesWhatIsTooMuchFromBesideIt) {
  std::vector<glm::vec2> volumes(101, glm::vec2(1.0f, 1.0f));
  for (size_t p = 0; p < 4; ++p) volumes[p].y = 1.3f;
  const std::vector<float> factors = VolumeBalance(row(), 1.0f).factors(volumes);
  double drawn = 0.0;
  for (size_t p = 0; p < volumes.size(); ++p) drawn += factors[p] * volumes[p].y;
  EXPECT_NEAR(drawn, 101.0, 1e-3);
  EXPECT_LT(factors.front(), 0.95f);
  EXPECT_NEAR(factors[25], 1.0f, 1e-6f);
  EXPECT_NEAR(factors.back(), 1.0f, 1e-6f);
}

TEST(VolumeBalance, ChangesHeightsByAQuarterAtMost) {
  for (const float drawn : {0.01f, 100.0f}) {
    const std::vector<glm::vec2> volumes(101, glm::vec2(1.0f, drawn));
    for (const float factor : VolumeBalance(row(), 1.0f).factors(volumes)) {
      EXPECT_NEAR(factor, drawn < 1.0f ? 1.25f : 0.75f, 1e-5f);
    }
  }
}

TEST(VolumeBalance, TakesPointsFarFromTheOrigin) {
  const std::vector<glm::vec2> volumes(101, glm::vec2(1.0f, 1.0f));
  for (const float factor : VolumeBalance(row(4e10f), 1.0f).factors(volumes)) {
    EXPECT_TRUE(std::isfinite(factor));
  }
}

}  // namespace
}  // namespace snowbough::snow
