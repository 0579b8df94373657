#include "tree/obj/seams.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <string>

#include "tree/obj/parts.h"

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

/// A square tube along x from `root` with five rings, every face on vertices of its own.
void add_loose_tube(ObjScene& scene, glm::vec3 root, float radius) {
  const auto corner = [&](int ring, int side) {
    const float r = radius * (1.0f - 0.1f * static_cast<float>(ring));
    constexpr float kY[] = {1, 0, -1, 0};
    return root + glm::vec3(static_cast<float>(ring), r * kY[side % 4], r * kY[(side + 1) % 4]);
  };
  for (int ring = 0; ring < 4; ++ring) {
    for (int side = 0; side < 4; ++side) {
      const glm::vec3 a = corner(ring, side), b = corner(ring, side + 1),
                      c = corner(ring + 1, side + 1), d = corner(ring + 1, side);
      add_loose_face(scene, {a, b, c, d});
    }
  }
}

Parts joined(ObjScene& scene) {
  close_seams(scene);
  return split_parts(scene);
}

TEST(Seams, JoinWithinOneGroupOnly) {
  // The tube's faces go by turns into two groups: each holds two of its sides.
  ObjScene whole;
  begin_group(whole, "");
  add_loose_tube(whole, {0, 0, 0}, 0.5f);
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
