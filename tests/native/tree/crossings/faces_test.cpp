#include "tree/crossings/faces.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace snowbough::tree
