#include "tree/leaves/islands.h"

#include <gtest/gtest.h>

#include <array>

namespace snowbough::tree {
namespace {

Foliage triangles(const std::vector<std::array<int32_t, 3>>& faces) {
  Foliage foliage;
  foliage.face_begin = {0};
  for (const auto& face : faces) {
    foliage.corner_vertex.insert(foliage.corner_vertex.end(), face.begin(), face.end());
    foliage.face_begin.push_back(static_cast<int32_t>(foliage.corner_vertex.size()));
  }
  return foliage;
}

TEST(FaceConnections, FacesThatShareAnEdgeAreOneIslandAndThoseThatShareAVertexAreTwo) {
  const Foliage foliage = triangles({{0, 1, 2}, {2, 4, 5}, {0, 2, 3}});
  FaceConnections connections;
  connections.find(foliage, std::array<int32_t, 3>{0, 1, 2});
  EXPECT_EQ(connections.island_count(), 2);
  EXPECT_EQ(connections.island_of(), (std::vector<int32_t>{0, 1, 0}));
  EXPECT_EQ(connections.outline().size(), 7u);
  EXPECT_TRUE(connections.two_sided());
}

TEST(FaceConnections, AnEdgeThatBothFacesGoAlongTheSameWayIsNotTwoSided) {
  const Foliage foliage = triangles({{0, 1, 2}, {0, 1, 3}});
  FaceConnections connections;
  connections.find(foliage, std::array<int32_t, 2>{0, 1});
  EXPECT_EQ(connections.island_count(), 1);
  EXPECT_FALSE(connections.two_sided());
}

TEST(FaceConnections, WhatWasFoundForOneLeafIsNotKeptForOneThatIsNumberedOtherwise) {
  const Foliage foliage = triangles({{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {7, 8, 9}});
  FaceConnections connections;
  connections.find(foliage, std::array<int32_t, 2>{0, 1});
  EXPECT_EQ(connections.island_count(), 1);
  connections.find(foliage, std::array<int32_t, 2>{2, 3});
  EXPECT_EQ(connections.island_count(), 2);
}

}  // namespace
}  // namespace snowbough::tree
