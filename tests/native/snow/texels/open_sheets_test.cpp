#include "snow/texels/open_sheets.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace snowbough::snow {
namespace {

using Open = std::vector<uint8_t>;

const std::vector<glm::vec3> kSquare{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
const std::vector<glm::vec3> kCube{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                   {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
/// Bottom, four walls, and the lid last.
const std::vector<int32_t> kCubeFaces{0, 2, 1, 0, 3, 2, 0, 1, 5, 0, 5, 4, 1, 2, 6, 1, 6, 5,
                                      2, 3, 7, 2, 7, 6, 3, 0, 4, 3, 4, 7, 4, 5, 6, 4, 6, 7};

TEST(OpenSheets, ACardIsOpenAndACubeIsClosed) {
  EXPECT_EQ(find_open_sheets({0, 1, 2, 0, 2, 3}, kSquare), (Open{1, 1}));
  EXPECT_EQ(find_open_sheets(kCubeFaces, kCube), Open(12, 0));
}

TEST(OpenSheets, ACubeWithoutALidIsOpen) {
  const std::vector<int32_t> faces(kCubeFaces.begin(), kCubeFaces.end() - 6);
  EXPECT_EQ(find_open_sheets(faces, kCube), Open(10, 1));
}

TEST(OpenSheets, ACubeOfSeparateFacesIsClosedFarFromTheOriginToo) {
  for (const float scale : {1e-4f, 1.0f, 1e4f}) {
    std::vector<glm::vec3> positions;
    std::vector<int32_t> faces;
    for (const int32_t index : kCubeFaces) {
      faces.push_back(static_cast<int32_t>(positions.size()));
      positions.push_back(scale *
                          (kCube[static_cast<size_t>(index)] + glm::vec3(7.0f, -3.0f, 0.5f)));
    }
    EXPECT_EQ(find_open_sheets(faces, positions), Open(12, 0)) << scale;
  }
}

TEST(OpenSheets, PartsThatDoNotTouchAreJudgedAlone) {
  std::vector<glm::vec3> positions = kCube;
  for (const glm::vec3& point : kSquare) positions.push_back(point + glm::vec3(3.0f, 0.0f, 0.0f));
  std::vector<int32_t> faces = kCubeFaces;
  for (const int32_t index : {8, 9, 10, 8, 10, 11}) faces.push_back(index);
  Open expected(12, 0);
  expected.insert(expected.end(), {1, 1});
  EXPECT_EQ(find_open_sheets(faces, positions), expected);
}

/// A tube of radius 1 around z, open at both ends.
Open open_of_tube(float length) {
  constexpr int32_t kAround = 12;
  std::vector<glm::vec3> positions;
  std::vector<int32_t> faces;
  for (int32_t i = 0; i < kAround; ++i) {
    const float turn = 2.0f * std::numbers::pi_v<float> * static_cast<float>(i) / kAround;
    positions.emplace_back(std::cos(turn), std::sin(turn), 0.0f);
    positions.emplace_back(std::cos(turn), std::sin(turn), length);
    const int32_t a = 2 * i;
    const int32_t b = 2 * ((i + 1) % kAround);
    faces.insert(faces.end(), {a, b, b + 1, a, b + 1, a + 1});
  }
  return find_open_sheets(faces, positions);
}

TEST(OpenSheets, ALongOpenTubeIsClosedAndAShortOneIsOpen) {
  EXPECT_EQ(open_of_tube(20.0f), Open(24, 0));
  EXPECT_EQ(open_of_tube(1.0f), Open(24, 1));
}

TEST(OpenSheets, TwoCardsBackToBackAreClosed) {
  std::vector<glm::vec3> positions = kSquare;
  positions.insert(positions.end(), kSquare.begin(), kSquare.end());
  EXPECT_EQ(find_open_sheets({0, 1, 2, 0, 2, 3, 4, 6, 5, 4, 7, 6}, positions), Open(4, 0));
}

}  // namespace
}  // namespace snowbough::snow
