#include "tree/coverage/coverage.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "native/tree/tree_text.h"

namespace snowbough::tree {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// One part: a square tube along Z with a ring at each z from 0 to 4, and half a metre wide.
ObjScene tower() {
  ObjScene scene;
  for (int ring = 0; ring < 5; ++ring) {
    const auto z = static_cast<float>(ring);
    for (const auto& [x, y] : {std::pair(0.5f, 0.0f), {0.0f, 0.5f}, {-0.5f, 0.0f}, {0.0f, -0.5f}}) {
      scene.positions.emplace_back(x, y, z);
    }
  }
  for (int ring = 0; ring < 4; ++ring) {
    for (int c = 0; c < 4; ++c) {
      const int a = 4 * ring + c, b = 4 * ring + (c + 1) % 4;
      for (const int v : {a, b, b + 4, a + 4}) scene.corner_vertex.push_back(v);
      scene.face_begin.push_back(static_cast<int32_t>(scene.corner_vertex.size()));
    }
  }
  scene.runs.push_back({});
  return scene;
}

/// Share of the tower that a limb from z = `low` to `high` represents.
double share(float low, float high, float radius) {
  const ObjScene scene = tower();
  const Parts parts = split_parts(scene);
  ClassifiedParts classified;
  classified.role.assign(1, PartRole::kTube);
  Branch limb;
  limb.piece = 0;
  for (float z = low; z <= high; z += 1.0f) limb.points.emplace_back(0, 0, z);
  limb.radii.assign(limb.points.size(), radius);
  limb.areas.assign(limb.points.size(), radius);
  return measure_coverage(scene, parts, classified, {limb}).share();
}

TEST(Coverage, ALimbThatFollowsItsPolygonsIsWhole) {
  EXPECT_NEAR(share(0, 4, 0.5f), 1.0, 1e-9);
}

TEST(Coverage, AStumpRepresentsOnlyItself) {
  // Rings 0 and 1, and nothing of the rings above.
  EXPECT_NEAR(share(0, 1, 0.5f), 1.5 / 4.0, 1e-6);
}

TEST(Coverage, AWireInATrunkIsNoTrunk) {
  EXPECT_DOUBLE_EQ(share(0, 4, 0.1f), 0.0);
}

TEST(Coverage, ALimbBeyondItsPolygonsCountsForLess) {
  // Of 11 m the lowest six have polygons within twice the radius and a step.
  EXPECT_NEAR(share(0, 11, 0.5f), 6.0 / 11.0, 0.1);
}

TEST(Coverage, WoodWithoutALimbIsMissing) {
  const ObjScene scene = tower();
  const Parts parts = split_parts(scene);
  ClassifiedParts classified;
  classified.role.assign(1, PartRole::kSkipped);
  classified.skipped.push_back({0, "not a tube", true});
  const Coverage coverage = measure_coverage(scene, parts, classified, {});
  EXPECT_DOUBLE_EQ(coverage.share(), 0.0);
  ASSERT_EQ(coverage.missing.size(), 1u);
  EXPECT_NEAR(coverage.missing[0].second, coverage.area, 1e-9);
}

TEST(Coverage, OfMissingWoodTheLargestPartIsFirst) {
  ObjScene scene = tower();
  const auto large = static_cast<int32_t>(scene.positions.size());
  const size_t faces = scene.face_begin.size() - 1, corners = scene.corner_vertex.size();
  for (int32_t v = 0; v < large; ++v) {
    scene.positions.push_back(scene.positions[v] * 3.0f + glm::vec3(9, 0, 0));
  }
  for (size_t c = 0; c < corners; ++c) {
    scene.corner_vertex.push_back(scene.corner_vertex[c] + large);
  }
  for (size_t f = 1; f <= faces; ++f) {
    scene.face_begin.push_back(scene.face_begin[f] + static_cast<int32_t>(corners));
  }
  const Parts parts = split_parts(scene);
  ASSERT_EQ(parts.count(), 2);
  ClassifiedParts classified;
  classified.role.assign(2, PartRole::kSkipped);
  for (const int32_t part : {0, 1}) classified.skipped.push_back({part, "not a tube", true});
  const Coverage coverage = measure_coverage(scene, parts, classified, {});
  ASSERT_EQ(coverage.missing.size(), 2u);
  EXPECT_EQ(coverage.missing[0].first, 1);
  EXPECT_NEAR(coverage.missing[0].second, 9.0 * coverage.missing[1].second, 1e-4);
}

TEST_F(ReadTree, ReportsHowMuchOfTheWoodItsLimbsRepresent) {
  TreeText text;
  text.tree(false, numbered);
  const Skeleton skeleton = read(text.text());
  EXPECT_GT(skeleton.report.coverage, 0.99);
  EXPECT_THAT(skeleton.report.wood_name, "trunk1");
}

/// TreeText's tree with a heap of wood that is no limb.
std::string with_heap(int triangles) {
  TreeText text;
  text.tree(false, numbered);
  text.line("g wooden_heap");
  for (int i = 0; i < 3 * triangles; ++i) {
    text.line("v " + std::to_string(20 + (i * 7) % 11) + " " + std::to_string((i * 5) % 13) + " " +
              std::to_string((i * 3) % 7));
  }
  for (int i = 0; i < triangles; ++i) {
    text.line("f " + std::to_string(-3 * triangles + (3 * i) % (3 * triangles)) + " " +
              std::to_string(-3 * triangles + (3 * i + 1) % (3 * triangles)) + " " +
              std::to_string(-3 * triangles + (3 * i + 5) % (3 * triangles)));
  }
  return text.text();
}

TEST_F(ReadTree, SaysWhichWoodIsMissingAndWhatToDo) {
  const ImportReport report = read(with_heap(40)).report;
  EXPECT_LT(report.coverage, kLowCoverage);
  EXPECT_THAT(report.warnings, Contains(HasSubstr("in 'wooden_heap'")));
  EXPECT_THAT(report.warnings, Contains(HasSubstr("Keep Original Surface")));
}

TEST_F(ReadTree, DecalsAndKnotsOnLimbsAreKeptAsCards) {
  TreeText text;
  text.tree(false, numbered);
  text.line("g Decals").leaf({0.5f, 0, 1}, {0, 0.1f, 0});
  text.line("g Knots").leaf({0.5f, 0, 2}, {0, 0.1f, 0});
  const Skeleton skeleton = read(text.text());
  EXPECT_EQ(skeleton.branches.size(), 9u);
  EXPECT_EQ(skeleton.foliage.leaf_branch, (std::vector<int32_t>{0, 0}));
  EXPECT_THAT(skeleton.report.skipped_parts, IsEmpty());
}

TEST(PartNames, KnowSpeedTreesParts) {
  for (const char* name : {"Trunk_1", "Branches", "Big", "big_2", "Bifurcating", "Roots"}) {
    EXPECT_EQ(meaning_of_name(name), NameMeaning::kWood) << name;
  }
  for (const char* name : {"Cap", "Caps_3", "Knot", "Cavity", "Decals"}) {
    EXPECT_EQ(meaning_of_name(name), NameMeaning::kDetail) << name;
  }
  for (const char* name : {"Frond", "Leaf Meshes", "Leaves"}) {
    EXPECT_EQ(meaning_of_name(name), NameMeaning::kFoliage) << name;
  }
  for (const char* name : {"Big_Oak", "knotweed", "RootNode", "capsule"}) {
    EXPECT_EQ(meaning_of_name(name), NameMeaning::kSilent) << name;
  }
}

}  // namespace
}  // namespace snowbough::tree
