#include "snow/surface/face_parts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "snow/surface/surface_mesh.h"

namespace snowbough::snow {
namespace {

using ::testing::ElementsAre;

/// Triangles around the edge from (0, 0, 0) to (1, 0, 0), at angles in degrees.
SurfaceMesh wheel(const std::vector<float>& angles) {
  SurfaceMesh mesh;
  mesh.position = {{0, 0, 0}, {1, 0, 0}};
  for (const float degrees : angles) {
    const float angle = degrees * std::numbers::pi_v<float> / 180.0f;
    const auto tip = static_cast<int32_t>(mesh.position.size());
    mesh.position.emplace_back(0.5f, std::cos(angle), std::sin(angle));
    mesh.triangle.push_back({0, 1, tip});
  }
  return mesh;
}

TEST(FaceParts, OfAClosedBodyIsOne) {
  const SurfaceMesh mesh = wheel({0, 80});
  EXPECT_THAT(face_parts(mesh), ElementsAre(0, 0));
}

TEST(FaceParts, AWallOnAFloorIsAnother) {
  EXPECT_THAT(face_parts(wheel({0, 90, 180})), ElementsAre(0, 1, 0));
}

TEST(FaceParts, OfAWheelAreItsBladesWithThoseOpposite) {
  EXPECT_THAT(face_parts(wheel({0, 45, 90, 135, 180, 225, 270, 315})),
              ElementsAre(0, 1, 2, 3, 0, 1, 2, 3));
}

TEST(FaceParts, OfAnOddWheelDoNotJoinInAChain) {
  const std::vector<int32_t> parts = face_parts(wheel({0, 51, 103, 154, 206, 257, 309}));
  for (const int32_t part : parts) EXPECT_LE(std::count(parts.begin(), parts.end(), part), 2);
  EXPECT_THAT(parts, testing::Contains(testing::Ne(0)));
}

TEST(FaceParts, ThreeFacesAtEqualAnglesAreThree) {
  EXPECT_THAT(face_parts(wheel({0, 120, 240})), ElementsAre(0, 1, 2));
}

TEST(FaceParts, SheetsThatAreModelledTwiceAreOne) {
  EXPECT_THAT(face_parts(wheel({0, 180, 180, 0})), ElementsAre(0, 0, 0, 0));
}

TEST(FaceParts, FacesThatMeetAtAPointAreApart) {
  SurfaceMesh mesh;
  mesh.position = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
  mesh.triangle = {{0, 1, 2}, {0, 3, 4}};
  EXPECT_THAT(face_parts(mesh), ElementsAre(0, 1));
}

}  // namespace
}  // namespace snowbough::snow
