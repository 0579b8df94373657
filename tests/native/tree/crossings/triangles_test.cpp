#include "tree/crossings/triangles.h"

#include <gtest/gtest.h>

#include <cmath>

namespace snowbough::tree {
namespace {

TEST(Triangles, PiercingCountsAndTouchingAtASharedCornerDoesNot) {
  const Triangle floor = {glm::dvec3(0, 0, 0), glm::dvec3(2, 0, 0), glm::dvec3(0, 2, 0)};
  const Triangle piercing = {glm::dvec3(0.5, 0.5, -1), glm::dvec3(0.6, 0.5, 1),
                             glm::dvec3(0.5, 0.6, 1)};
  const Triangle above = {glm::dvec3(0, 0, 0), glm::dvec3(1, 0, 1), glm::dvec3(0, 1, 1)};
  const Triangle through = {glm::dvec3(0, 0, 0), glm::dvec3(1, 1, 1), glm::dvec3(1, 1, -1)};
  EXPECT_TRUE(triangles_cross(floor, piercing, {-1, -1, -1}));
  EXPECT_FALSE(triangles_cross(floor, above, {0, -1, -1}));
  EXPECT_TRUE(triangles_cross(floor, through, {0, -1, -1}));
}

TEST(Triangles, ASharedEdgeCrossesOnlyWhenFoldedFlat) {
  const Triangle floor = {glm::dvec3(0, 0, 0), glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0)};
  const Triangle beside = {glm::dvec3(1, 0, 0), glm::dvec3(0, 0, 0), glm::dvec3(0, -1, 0)};
  const Triangle folded = {glm::dvec3(1, 0, 0), glm::dvec3(0, 0, 0), glm::dvec3(0.2, 0.7, 0)};
  EXPECT_FALSE(triangles_cross(floor, beside, {1, 0, -1}));
  EXPECT_TRUE(triangles_cross(floor, folded, {1, 0, -1}));
}

TEST(Triangles, OrientationIsExactNextToThePlane) {
  const glm::dvec3 a(0.1f, 0.1f, 0.1f), b(12.1f, 0.1f, 0.1f), c(0.1f, 24.1f, 0.1f);
  const double above = std::nextafter(0.1f, 1.0f);
  EXPECT_EQ(orientation(a, b, c, {3.3f, 4.7f, 0.1f}), 0);
  EXPECT_EQ(orientation(a, b, c, {3.3f, 4.7f, above}), -1);
}

}  // namespace
}  // namespace snowbough::tree
