#include "tree/surface/limb_hull.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <glm/geometric.hpp>
#include <random>
#include <vector>

namespace snowbough::tree {
namespace {

Ring ring_at(const glm::dvec3& centre, double corner) {
  Ring ring;
  ring.centre = centre;
  ring.corner = corner;
  return ring;
}

TEST(LimbHull, TellsWhatStandsClearOfATaperingLimb) {
  const LimbHull hull({ring_at({0, 0, 0}, 2.0), ring_at({0, 0, 10}, 1.0)});
  EXPECT_TRUE(hull.clears({1.6, 0, 5}, 0.05));
  EXPECT_FALSE(hull.clears({1.6, 0, 5}, 0.15));
  EXPECT_FALSE(hull.clears({1.6, 0, 2}, 0.05));
  EXPECT_TRUE(hull.clears({0, 0, 11.1}, 0.05));
}

TEST(LimbHull, EverythingStandsClearOfALimbWithoutRings) {
  EXPECT_TRUE(LimbHull().clears({0, 0, 0}, 1.0));
  EXPECT_TRUE(LimbHull({ring_at({0, 0, 0}, 1.0)}).clears({0, 0, 0}, 1.0));
}

/// One cone after the other.
bool clears_one_by_one(const std::vector<Ring>& rings, const glm::dvec3& point, double margin) {
  for (size_t i = 0; i + 1 < rings.size(); ++i) {
    const glm::dvec3 along = rings[i + 1].centre - rings[i].centre;
    const double square = glm::dot(along, along);
    const double t = square > 0.0
                         ? std::clamp(glm::dot(point - rings[i].centre, along) / square, 0.0, 1.0)
                         : 0.0;
    const double corner = rings[i].corner + (rings[i + 1].corner - rings[i].corner) * t;
    if (glm::distance(point, rings[i].centre + along * t) - corner <= margin) return false;
  }
  return true;
}

TEST(LimbHull, AgreesWithEveryConeLookedAtOneByOne) {
  constexpr uint32_t kSeed = 20;
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  std::mt19937 random(kSeed);
  const auto unit = [&] { return static_cast<double>(random()) * 0x1p-32; };
  int clear = 0;
  for (int limb = 0; limb < 50; ++limb) {
    std::vector<Ring> rings;
    glm::dvec3 at(1000.0 * unit(), 0.0, 0.0);
    for (int i = 0; i < 2 + 5 * limb; ++i) {
      rings.push_back(ring_at(at, 0.5 * unit() * unit()));
      // Some rings stand at one place.
      if (i % 7 != 3) at += glm::dvec3(0.2 * unit() - 0.1, 0.2 * unit() - 0.1, 0.3 * unit());
    }
    const LimbHull hull(rings);
    for (int i = 0; i < 200; ++i) {
      const Ring& beside = rings[random() % rings.size()];
      const glm::dvec3 point = beside.centre + glm::dvec3(unit() - 0.5, unit() - 0.5, unit() - 0.5);
      const double margin = 0.1 * unit();
      const bool expected = clears_one_by_one(rings, point, margin);
      ASSERT_EQ(hull.clears(point, margin), expected) << "limb " << limb << ", point " << i;
      clear += expected ? 1 : 0;
    }
  }
  EXPECT_GT(clear, 2000);
  EXPECT_LT(clear, 8000);
}

}  // namespace
}  // namespace snowbough::tree
