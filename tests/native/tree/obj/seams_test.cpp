#include "tree/obj/seams.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <glm/geometric.hpp>
#include <string>

#include "tree/obj/parts.h"
#include "tree/rings/rings.h"

namespace snowbough::tree {
namespace {

using testing::ElementsAre;

void begin_group(ObjScene& scene, const std::string& name) {
  FaceRun run;
  run.first_face = scene.face_count();
  run.group = static_cast<int32_t>(scene.names.size());
  scene.names.push_back(name);
  scene.runs.push_back(run);
}

/// One polygon on vertices of its own.
void add_loose_face(ObjScene& scene, const std::vector<glm::vec3>& corners) {
  for (const glm::vec3& p : corners) {
    scene.corner_vertex.push_back(static_cast<int32_t>(scene.positions.size()));
    scene.positions.push_back(p);
  }
  scene.face_begin.push_back(static_cast<int32_t>(scene.corner_vertex.size()));
}

/// A triangle of a square that shares the first one's indices: a quad split in two.
void add_split_quad(ObjScene& scene, const std::array<glm::vec3, 4>& corners) {
  const auto first = static_cast<int32_t>(scene.positions.size());
  scene.positions.insert(scene.positions.end(), corners.begin(), corners.end());
  for (const int32_t c : {0, 1, 2, 0, 2, 3}) scene.corner_vertex.push_back(first + c);
  scene.face_begin.push_back(static_cast<int32_t>(scene.corner_vertex.size()) - 3);
  scene.face_begin.push_back(static_cast<int32_t>(scene.corner_vertex.size()));
}

enum class Faces { kQuads, kTriangles, kSplitQuads };

/// A square tube along x from `root` with five rings, every face on vertices of its own.
void add_loose_tube(ObjScene& scene, glm::vec3 root, float radius, Faces faces) {
  const auto corner = [&](int ring, int side) {
    const float r = radius * (1.0f - 0.1f * static_cast<float>(ring));
    constexpr float kY[] = {1, 0, -1, 0};
    return root + glm::vec3(static_cast<float>(ring), r * kY[side % 4], r * kY[(side + 1) % 4]);
  };
  for (int ring = 0; ring < 4; ++ring) {
    for (int side = 0; side < 4; ++side) {
      const glm::vec3 a = corner(ring, side), b = corner(ring, side + 1),
                      c = corner(ring + 1, side + 1), d = corner(ring + 1, side);
      if (faces == Faces::kQuads) {
        add_loose_face(scene, {a, b, c, d});
      } else if (faces == Faces::kTriangles) {
        add_loose_face(scene, {a, b, c});
        add_loose_face(scene, {a, c, d});
      } else {
        add_split_quad(scene, {a, b, c, d});
      }
    }
  }
}

Parts joined(ObjScene& scene) {
  close_seams(scene);
  return split_parts(scene);
}

std::optional<Limb> trace_joined(const ObjScene& scene, const Parts& parts, int32_t part) {
  NotATube why;
  return trace_tube(scene, parts.part_faces(part), parts.part_vertices(part), why);
}

TEST(Seams, MakeATubeWhateverTheyAre) {
  for (const Faces faces : {Faces::kQuads, Faces::kTriangles, Faces::kSplitQuads}) {
    ObjScene scene;
    begin_group(scene, "");
    add_loose_tube(scene, {0, 0, 0}, 0.5f, faces);
    const Parts parts = joined(scene);
    ASSERT_EQ(parts.count(), 1);
    EXPECT_EQ(parts.vertices.size(), 20u);
    const auto limb = trace_joined(scene, parts, 0);
    ASSERT_TRUE(limb);
    ASSERT_EQ(limb->points.size(), 5u);
    EXPECT_LT(glm::distance(limb->points[3], glm::vec3(3, 0, 0)), 1e-6f);
    EXPECT_FLOAT_EQ(limb->radii[0], 0.5f);
  }
}

TEST(Seams, TubesThatTouchAlongAnEdgeStayApart) {
  // The second tube lies beside the first: the edges of one side are in both.
  ObjScene scene;
  begin_group(scene, "");
  add_loose_tube(scene, {0, 0, 0}, 0.5f, Faces::kQuads);
  const size_t first_end = scene.positions.size();
  add_loose_tube(scene, {0, 0, 0}, 0.5f, Faces::kQuads);
  // Mirrored at the plane y = 0.5 * (1 - 0.1 x) that touches the first along a line of vertices.
  for (size_t v = first_end; v < scene.positions.size(); ++v) {
    glm::vec3& p = scene.positions[v];
    const float r = 0.5f * (1.0f - 0.1f * p.x);
    p.y = p.y == r ? p.y : 2.0f * r - p.y;
  }
  const Parts parts = joined(scene);
  ASSERT_EQ(parts.count(), 2);
  EXPECT_EQ(parts.part_faces(0).size(), 16u);
  EXPECT_EQ(parts.part_faces(1).size(), 16u);
  EXPECT_EQ(parts.part_faces(1).front(), 16);
  EXPECT_TRUE(trace_joined(scene, parts, 0));
  EXPECT_TRUE(trace_joined(scene, parts, 1));
}

TEST(Seams, JoinWithinOneGroupOnly) {
  // The tube's faces go by turns into two groups: each holds two of its sides.
  ObjScene whole;
  begin_group(whole, "");
  add_loose_tube(whole, {0, 0, 0}, 0.5f, Faces::kQuads);
  ObjScene scene;
  for (int group = 0; group < 2; ++group) {
    begin_group(scene, group == 0 ? "a" : "b");
    for (int32_t f = group; f < whole.face_count(); f += 2) {
      const auto corner = whole.positions.begin() + 4 * f;
      add_loose_face(scene, {corner, corner + 4});
    }
  }
  EXPECT_EQ(joined(scene).count(), 4);
}

TEST(Seams, ALeafOfSeveralStripsIsOnePartAndPlanesStayAlone) {
  ObjScene scene;
  begin_group(scene, "");
  // A leaf folded along its middle, a leaf of three strips, a row of planes.
  add_loose_face(scene, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0.2f}, {0, 1, 0.2f}});
  add_loose_face(scene, {{1, 0, 0}, {0, 0, 0}, {0, -1, 0.2f}, {1, -1, 0.2f}});
  for (float x : {5.0f, 6.0f, 7.0f}) {
    add_loose_face(scene, {{x, 0, 0}, {x + 1, 0, 0}, {x + 1, 1, 0}, {x, 1, 0}});
  }
  for (float z : {1.0f, 2.0f, 3.0f}) {
    add_loose_face(scene, {{0, 0, z}, {1, 0, z}, {1, 1, z}, {0, 1, z}});
  }
  EXPECT_EQ(joined(scene).count(), 5);
}

TEST(Seams, ThreeEdgesAtOnePlaceStayOpen) {
  ObjScene scene;
  begin_group(scene, "");
  add_loose_face(scene, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}});
  add_loose_face(scene, {{1, 0, 0}, {0, 0, 0}, {0, -1, 0}});
  add_loose_face(scene, {{1, 0, 0}, {0, 0, 0}, {0, 0, 1}});
  EXPECT_EQ(joined(scene).count(), 3);
}

TEST(Seams, AConeWithoutWidthKeepsItsCorners) {
  ObjScene scene;
  begin_group(scene, "twig");
  scene.positions = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {1, 0, 0}};
  for (const int32_t side : {0, 1, 2}) {
    for (const int32_t v : {side, 3, (side + 1) % 3}) scene.corner_vertex.push_back(v);
    scene.face_begin.push_back(static_cast<int32_t>(scene.corner_vertex.size()));
  }
  const std::vector<int32_t> before = scene.corner_vertex;
  close_seams(scene);
  EXPECT_EQ(scene.corner_vertex, before);
}

TEST(Seams, TubesInARowBecomeOne) {
  // A trunk in two short tubes: the last ring of the first lies on the first ring of the second.
  ObjScene scene;
  begin_group(scene, "");
  add_loose_tube(scene, {0, 0, 0}, 0.5f, Faces::kQuads);
  const size_t second = scene.positions.size();
  add_loose_tube(scene, {0, 0, 0}, 0.5f, Faces::kQuads);
  for (size_t v = second; v < scene.positions.size(); ++v) {
    glm::vec3& p = scene.positions[v];
    p = glm::vec3(8.0f - p.x, p.y, -p.z);
  }
  const Parts parts = joined(scene);
  ASSERT_EQ(parts.count(), 1);
  const auto limb = trace_joined(scene, parts, 0);
  ASSERT_TRUE(limb);
  EXPECT_EQ(limb->points.size(), 9u);
}

TEST(Seams, WeldedPositionsShareAVertexInAnyGroup) {
  ObjScene scene;
  begin_group(scene, "a");
  add_loose_face(scene, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}});
  begin_group(scene, "b");
  add_loose_face(scene, {{1, 1, 0}, {2, 0, 0}, {2, 2, 0}});
  weld_positions(scene);
  EXPECT_THAT(scene.corner_vertex, ElementsAre(0, 1, 2, 2, 4, 5));
}

}  // namespace
}  // namespace snowbough::tree
