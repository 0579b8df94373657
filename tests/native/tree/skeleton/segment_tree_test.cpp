// What the reader searches with: the tree of segments, the component's own mesh, its ends.
#include "tree/skeleton/segment_tree.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <random>

#include "tree/rings/closed_ends.h"
#include "tree/rings/local_mesh.h"

namespace snowbough::tree {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;

Branch line(std::vector<glm::vec3> points, float radius) {
  Branch branch;
  branch.points = std::move(points);
  branch.radii.assign(branch.points.size(), radius);
  return branch;
}

TEST(SegmentTree, FindsTheNearestOfRandomSegments) {
  constexpr uint32_t kSeed = 7;
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  std::mt19937 random(kSeed);
  const auto unit = [&] { return static_cast<float>(random() * 0x1p-32); };
  const auto place = [&] { return glm::vec3(unit(), unit(), unit()); };
  std::vector<Branch> branches;
  for (int i = 0; i < 60; ++i) {
    branches.push_back(line({place(), place(), place()}, 0.0f));
  }
  const SegmentTree tree(branches, std::vector<int32_t>(branches.size(), 0), 0.0f);
  for (int i = 0; i < 200; ++i) {
    const glm::vec3 point = place();
    double nearest = std::numeric_limits<double>::infinity();
    for (const Branch& branch : branches) {
      for (size_t s = 0; s + 1 < branch.points.size(); ++s) {
        const glm::dvec3 a(branch.points[s]), ab = glm::dvec3(branch.points[s + 1]) - a;
        const double t =
            glm::clamp(glm::dot(glm::dvec3(point) - a, ab) / glm::dot(ab, ab), 0.0, 1.0);
        nearest = std::min(nearest, glm::distance(glm::dvec3(point), a + t * ab));
      }
    }
    EXPECT_NEAR(tree.nearest(point, 1, Measure::kDistance).cost, nearest, 1e-6);
  }
}

TEST(SegmentTree, MeasuresToTheSurfaceOrInRadii) {
  // A thick limb 3 m away with its surface at 1 m, a thin one 2 m away.
  const std::vector<Branch> branches = {line({{3, 0, -5}, {3, 0, 5}}, 2.0f),
                                        line({{-2, 0, -5}, {-2, 0, 5}}, 0.1f)};
  const SegmentTree tree(branches, {0, 0}, 0.0f);
  const glm::vec3 origin(0.0f);
  EXPECT_EQ(tree.nearest(origin, 1, Measure::kDistance).branch, 1);
  EXPECT_EQ(tree.nearest(origin, 1, Measure::kSurface).branch, 0);
  EXPECT_EQ(tree.nearest(origin, 1, Measure::kRadii).branch, 0);
  EXPECT_DOUBLE_EQ(tree.nearest(origin, 1, Measure::kRadii).cost, 1.5);
}

TEST(SegmentTree, FindsTheSameAsAmongEachSegmentAlone) {
  for (const float scale : {1e-4f, 1.0f, 1e5f}) {
    SCOPED_TRACE(testing::Message() << "scale " << scale);
    std::mt19937 random(11);
    // Far from the origin, where floats are coarse.
    const auto unit = [&] { return scale * (30.0f + static_cast<float>(random() * 0x1p-32)); };
    const auto place = [&] { return glm::vec3(unit(), unit(), unit()); };
    std::vector<Branch> branches;
    std::vector<SegmentTree> alone;
    for (int i = 0; i < 100; ++i) {
      const glm::vec3 a = place();
      branches.push_back(line({a, a + 0.1f * (place() - a)}, 0.1f * (unit() - 30.0f * scale)));
      alone.emplace_back(std::vector<Branch>{branches.back()}, std::vector<int32_t>{0}, 0.0f);
    }
    const SegmentTree tree(branches, std::vector<int32_t>(branches.size(), 0), 0.0f);
    for (int i = 0; i < 300; ++i) {
      const glm::vec3 point = place();
      for (const Measure measure : {Measure::kDistance, Measure::kRadii, Measure::kSurface}) {
        NearestSegment best;
        best.cost = std::numeric_limits<double>::infinity();
        for (size_t b = 0; b < alone.size(); ++b) {
          const NearestSegment found = alone[b].nearest(point, 1, measure);
          if (found.cost < best.cost) {
            best = found;
            best.branch = static_cast<int32_t>(b);
          }
        }
        const NearestSegment found = tree.nearest(point, 1, measure);
        ASSERT_EQ(found.branch, best.branch);
        ASSERT_EQ(found.cost, best.cost);
      }
    }
  }
}

TEST(SegmentTree, SeesOnlyWhatMayBeFound) {
  const std::vector<Branch> branches = {line({{1, 0, 0}, {1, 0, 1}}, 0.1f),
                                        line({{2, 0, 0}, {2, 0, 1}}, 0.1f),
                                        line({{3, 0, 0}, {3, 0, 1}}, 0.1f)};
  const SegmentTree tree(branches, {2, 1, 0}, 0.0f);
  const glm::vec3 origin(0.0f);
  EXPECT_EQ(tree.nearest(origin, 3, Measure::kDistance).branch, 0);
  EXPECT_EQ(tree.nearest(origin, 2, Measure::kDistance).branch, 1);
  EXPECT_EQ(tree.nearest(origin, 0, Measure::kDistance).branch, -1);
  const std::vector<char> excluded = {1, 1, 0};
  EXPECT_EQ(tree.nearest(origin, 3, Measure::kDistance, &excluded).branch, 2);
  EXPECT_EQ(tree.nearest(origin, 3, Measure::kDistance, nullptr, 0.5).branch, -1);
}

TEST(SegmentTree, OfEqualsTheFirstIsFoundAndAPointIsASegment) {
  const std::vector<Branch> branches = {line({{0, 1, 0}}, 0.1f), line({{0, -1, 0}}, 0.1f)};
  const NearestSegment found =
      SegmentTree(branches, {0, 0}, 0.0f).nearest(glm::vec3(0.0f), 1, Measure::kDistance);
  EXPECT_EQ(found.branch, 0);
  EXPECT_EQ(found.point, glm::vec3(0, 1, 0));
}

/// A tube of `rings` squares along z, open at both ends.
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

TEST(LocalMesh, AnOpenTubeHasTwoBordersAndWalksRingByRing) {
  const LocalMesh mesh = tube(4);
  const Topology topology = build_topology(mesh);
  EXPECT_THAT(topology.boundary_loops,
              ElementsAre(ElementsAre(0, 1, 2, 3), ElementsAre(12, 13, 14, 15)));
  EXPECT_THAT(walk_layers(mesh, topology, {0, 1, 2, 3}),
              ElementsAre(ElementsAre(0, 1, 2, 3), ElementsAre(4, 5, 6, 7),
                          ElementsAre(8, 9, 10, 11), ElementsAre(12, 13, 14, 15)));
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
  const Layers ends = closed_ends(mesh, topology);
  EXPECT_THAT(ends, Contains(ElementsAre(0, 1, 2, 3)));
  EXPECT_THAT(ends, Contains(ElementsAre(20, 21, 22, 23)));
}

}  // namespace
}  // namespace snowbough::tree
