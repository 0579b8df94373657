#include "tree/tubes/fine_mesh.h"

#include <gtest/gtest.h>

namespace snowbough::tree {
namespace {

/// One face of a limb that has half as many sides at its end: corner 2 lies along its side.
struct Change {
  FineMesh fine;
  std::vector<glm::dvec3> points = {
      {0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {1.0, 1.0, 0.5}, {1.0, 4.0, 0.0}};

  Change() {
    fine.quads = {{0, 1, 2, 3}};
    fine.face = {0};
    fine.corners = {{{{0.5, 0.0}, {1.0, 0.0}, {1.0, 0.25}, {1.0, 1.0}}}};
  }
};

TEST(FineMesh, AVertexAlongASideIsPutBackOntoIt) {
  Change change;
  const uint8_t face = 1;
  straighten(change.fine, {&face, 1}, change.points);
  EXPECT_EQ(change.points[2], glm::dvec3(1.0, 1.0, 0.0));
  EXPECT_EQ(change.points[1], glm::dvec3(1.0, 0.0, 0.0));
}

TEST(FineMesh, FacesThatAreNotAskedForStayAsTheyAre) {
  Change change;
  const uint8_t face = 0;
  straighten(change.fine, {&face, 1}, change.points);
  EXPECT_EQ(change.points[2].z, 0.5);
}

TEST(FineMesh, OnlyAVertexAlongASideLiesBetweenOthers) {
  Change change;
  change.fine.vertices.resize(4);
  EXPECT_EQ(between_others(change.fine), (std::vector<uint8_t>{0, 0, 1, 0}));
}

TEST(FineMesh, AVertexBetweenTwoAroundALimbStays) {
  Change change;
  change.fine.corners = {{{{0.0, 0.5}, {0.0, 1.0}, {0.25, 1.0}, {1.0, 1.0}}}};
  const uint8_t face = 1;
  straighten(change.fine, {&face, 1}, change.points);
  EXPECT_EQ(change.points[2].z, 0.5) << "limbs are round";
}

}  // namespace
}  // namespace snowbough::tree
