#include "tree/crossings/faces.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "tree/surface/surface.h"

namespace snowbough::tree {
namespace {

/// A unit square in the plane z = 0 and a second face given by its corners.
Surface square_and(const std::vector<glm::dvec3>& corners, const Quad& quad) {
  Surface surface;
  surface.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  surface.vertices.insert(surface.vertices.end(), corners.begin(), corners.end());
  surface.quads = {{0, 1, 2, 3}, quad};
  return surface;
}

bool cross(const Surface& surface) {
  return faces_cross(make_crossing_face(surface.vertices, surface.quads, 0),
                     make_crossing_face(surface.vertices, surface.quads, 1));
}

TEST(CrossingFace, FacesThroughEachOtherCross) {
  EXPECT_TRUE(cross(
      square_and({{0.5, 0.2, -1}, {0.5, 0.8, -1}, {0.5, 0.8, 1}, {0.5, 0.2, 1}}, {4, 5, 6, 7})));
}

TEST(CrossingFace, FacesAboveEachOtherDoNotCross) {
  EXPECT_FALSE(
      cross(square_and({{0, 0, 0.1}, {1, 0, 0.1}, {1, 1, 0.1}, {0, 1, 0.1}}, {4, 5, 6, 7})));
}

TEST(CrossingFace, FacesThatOnlyShareAnEdgeDoNotCross) {
  EXPECT_FALSE(cross(square_and({{1, 0, 1}, {1, 1, 1}}, {1, 4, 5, 2})));
}

/// Four squares around the vertex 4, which is moved by `middle`; of a grid of nine vertices.
std::vector<CrossingFace> four_around(const glm::dvec3& middle,
                                      const std::vector<glm::dvec3>& moves = {}) {
  Surface surface;
  for (int i = 0; i < 9; ++i) {
    surface.vertices.emplace_back(i % 3, i / 3, 0);
    if (!moves.empty()) surface.vertices.back() += moves[i];
  }
  surface.vertices[4] += middle;
  surface.quads = {{0, 1, 4, 3}, {1, 2, 5, 4}, {3, 4, 7, 6}, {4, 5, 8, 7}};
  std::vector<CrossingFace> faces;
  for (int f = 0; f < 4; ++f) {
    faces.push_back(make_crossing_face(surface.vertices, surface.quads, f));
  }
  find_spread_corners(surface.vertices.size(), faces);
  return faces;
}

TEST(SpreadCorners, AreThoseAroundAVertexWhoseFacesLieSideBySide) {
  const std::vector<CrossingFace> faces = four_around({0.1, -0.2, 0.3});
  EXPECT_EQ(faces[0].spread, 4u);
  EXPECT_EQ(faces[1].spread, 8u);
  EXPECT_EQ(faces[2].spread, 2u);
  EXPECT_EQ(faces[3].spread, 1u);
}

TEST(SpreadCorners, AreNotWhereAFaceFoldsOverAnother) {
  for (const CrossingFace& face : four_around({1.3, 0.0, 0.0})) EXPECT_EQ(face.spread, 0u);
}

TEST(SpreadCorners, AreOnlyAtFacesThatDoNotCross) {
  constexpr uint32_t kSeed = 7;
  std::mt19937 random(kSeed);
  int spread = 0, crossing = 0;
  for (int round = 0; round < 20000; ++round) {
    std::uniform_real_distribution<double> move(-0.9, 0.9);
    std::vector<glm::dvec3> moves(9);
    for (glm::dvec3& m : moves) m = {move(random), move(random), move(random)};
    std::vector<CrossingFace> faces = four_around({}, moves);
    const bool is_spread = faces[0].spread != 0;
    for (CrossingFace& face : faces) face.spread = 0;
    bool cross = false;
    for (int f = 0; f < 4; ++f) {
      for (int g = f + 1; g < 4; ++g) cross |= faces_cross(faces[f], faces[g]);
    }
    EXPECT_FALSE(is_spread && cross) << "seed " << kSeed << ", round " << round;
    spread += is_spread ? 1 : 0;
    crossing += cross ? 1 : 0;
  }
  EXPECT_GT(spread, 1000);
  EXPECT_GT(crossing, 1000);
}

}  // namespace
}  // namespace snowbough::tree
