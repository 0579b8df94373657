#include "tree/rings/local_mesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "tree/rings/closed_ends.h"

namespace snowbough::tree {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

LocalMesh tube(int rings) {
  LocalMesh mesh;
  for (int i = 0; i < rings; ++i) {
    for (const glm::vec3 p :
         {glm::vec3(1, 0, i), glm::vec3(0, 1, i), glm::vec3(-1, 0, i), glm::vec3(0, -1, i)}) {
      mesh.positions.push_back(p);
    }
  }
  for (int i = 0; i + 1 < rings; ++i) {
    for (int k = 0; k < 4; ++k) {
      const int a = 4 * i + k, b = 4 * i + (k + 1) % 4;
      mesh.corners.insert(mesh.corners.end(), {a, b, b + 4, a + 4});
      mesh.face_begin.push_back(static_cast<int32_t>(mesh.corners.size()));
    }
  }
  return mesh;
}

TEST(LocalMesh, AWalkIsGivenUpWhereItsLayersAreTooUneven) {
  // Ten corners round a middle, and a strip that ends in another middle: 1, 10, 10, 2 and 1.
  LocalMesh mesh;
  mesh.positions.resize(24);
  const auto face = [&](std::initializer_list<int32_t> corners) {
    mesh.corners.insert(mesh.corners.end(), corners);
    mesh.face_begin.push_back(static_cast<int32_t>(mesh.corners.size()));
  };
  for (int32_t k = 0; k < 10; ++k) {
    const int32_t next = (k + 1) % 10;
    face({0, 1 + k, 1 + next});
    face({1 + k, 11 + k, 11 + next, 1 + next});
  }
  face({11, 12, 22, 21});
  face({21, 22, 23});
  const Topology topology = build_topology(mesh);
  EXPECT_THAT(walk_layers(mesh, topology, {0}), SizeIs(5));
  EXPECT_THAT(walk_layers(mesh, topology, {0}, 5), SizeIs(5));
  EXPECT_THAT(walk_layers(mesh, topology, {0}, 4), IsEmpty());
}

TEST(LocalMesh, WeldingJoinsEqualPlacesAndDropsFacesThatVanish) {
  LocalMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, 0, 0}, {1, 1, 0}, {2, 0, 0}};
  mesh.corners = {0, 1, 2, 3, 5, 4, 1, 3, 2};
  mesh.face_begin = {0, 3, 6, 9};
  const LocalMesh welded = weld_equal_positions(mesh);
  EXPECT_EQ(welded.positions.size(), 4u);
  EXPECT_THAT(welded.face_begin, ElementsAre(0, 3, 6));
  EXPECT_THAT(welded.corners, ElementsAre(0, 1, 2, 1, 3, 2));
}

TEST(LocalMesh, AComponentIsRenumberedFrom0) {
  ObjScene scene;
  scene.positions = {{9, 9, 9}, {0, 0, 0}, {8, 8, 8}, {1, 0, 0}, {0, 1, 0}};
  scene.corner_vertex = {0, 2, 0, 4, 1, 3};
  scene.face_begin = {0, 3, 6};
  const std::vector<int32_t> faces = {1}, vertices = {1, 3, 4};
  const LocalMesh mesh = extract_component(scene, faces, vertices);
  EXPECT_THAT(mesh.positions,
              ElementsAre(glm::vec3(0, 0, 0), glm::vec3(1, 0, 0), glm::vec3(0, 1, 0)));
  EXPECT_THAT(mesh.corners, ElementsAre(2, 0, 1));
}

TEST(ClosedEnds, AClosedTubeMayEndAtItsCaps) {
  LocalMesh mesh = tube(6);
  mesh.corners.insert(mesh.corners.end(), {3, 2, 1, 0, 20, 21, 22, 23});
  mesh.face_begin.push_back(static_cast<int32_t>(mesh.corners.size()) - 4);
  mesh.face_begin.push_back(static_cast<int32_t>(mesh.corners.size()));
  const Topology topology = build_topology(mesh);
  EXPECT_THAT(topology.boundary_loops, IsEmpty());
  const Layers ends = closed_ends(mesh, topology, 64);
  EXPECT_THAT(ends, Contains(ElementsAre(0, 1, 2, 3)));
  EXPECT_THAT(ends, Contains(ElementsAre(20, 21, 22, 23)));
  EXPECT_EQ(closed_ends(mesh, topology, 3), Layers(ends.begin(), ends.begin() + 3));
}

TEST(ClosedEnds, TwoPolygonsOfManyCornersBackToBackAreOneFlatPatch) {
  // With quadratic cost this would take hours.
  constexpr int32_t kCorners = 200000;
  LocalMesh mesh;
  for (int32_t i = 0; i < kCorners; ++i) {
    const double angle = 2.0 * M_PI * i / kCorners;
    mesh.positions.emplace_back(std::cos(angle), std::sin(angle), 0.0);
    mesh.corners.push_back(i);
  }
  mesh.face_begin.push_back(kCorners);
  for (int32_t i = kCorners; i-- > 0;) mesh.corners.push_back(i);
  mesh.face_begin.push_back(2 * kCorners);
  const Topology topology = build_topology(mesh);
  for (const std::vector<int32_t>& end : closed_ends(mesh, topology, 64)) {
    EXPECT_TRUE(end.size() == 1 || end.size() == kCorners);
  }
  EXPECT_THAT(walk_layers(mesh, topology, {0}), SizeIs(2));
}

}  // namespace
}  // namespace snowbough::tree
