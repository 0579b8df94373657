#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "native/tree/grown_trees.h"
#include "native/tree/tree_text.h"
#include "tree/welded/uneven_tubes.h"

namespace snowbough::tree {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pair;

TEST_F(ReadTree, TubesOfTrianglesInAnyOrderWithFewerAndFewerCorners) {
  const std::vector<GrownLimb> limbs = grow_limbs(14, 15);
  const TriangleSoup soup = foliage_tubes(limbs);
  for (const uint32_t seed : {1u, 2u, 3u}) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Skeleton skeleton = read("g tree\n" + soup.text(seed), {.up_axis = UpAxis::kZ});
    EXPECT_EQ(skeleton.report.form, "MERGED_TUBES");
    EXPECT_THAT(skeleton.report.branches_per_level, ElementsAre(1, 14, 210));
    EXPECT_THAT(skeleton.report.skipped_parts, IsEmpty());
    EXPECT_EQ(skeleton.report.foliage_parts, 0);
    expect_limbs(limbs, skeleton, 0.01f);
  }
}

TEST_F(ReadTree, AWeldedTreeHasTheLimbsThatItWasMadeOf) {
  const std::vector<GrownLimb> limbs = grow_limbs(4, 2);
  const TriangleSoup soup =
      marched_surface([&](const glm::vec3& p) { return outside_tree(limbs, p); },
                      {-2.9f, -2.9f, -0.2f}, {2.9f, 2.9f, 8.3f}, 0.036f);
  for (const uint32_t seed : {4u, 5u}) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Skeleton skeleton = read(soup.text(seed));
    EXPECT_EQ(skeleton.report.form, "WELDED");
    EXPECT_EQ(skeleton.report.up_axis, "Z");
    EXPECT_THAT(skeleton.report.branches_per_level, ElementsAre(1, 4, 8));
    EXPECT_THAT(skeleton.report.extra_roots, IsEmpty());
    EXPECT_THAT(skeleton.report.skipped_parts, IsEmpty());
    expect_limbs(limbs, skeleton, 0.5f);
    EXPECT_EQ(skeleton.branches[0].name, "trunk");
    EXPECT_LT(glm::length(skeleton.branches[0].points[0]), 0.05f);
  }
}

TEST_F(ReadTree, KnotsOnAWeldedTrunkAreNoLimbs) {
  const std::vector<GrownLimb> limbs = grow_limbs(4, 0);
  const auto field = [&](const glm::vec3& p) {
    return std::min(outside_tree(limbs, p), glm::distance(p, glm::vec3(0.27f, 0, 1)) - 0.12f);
  };
  const TriangleSoup soup =
      marched_surface(field, {-2.9f, -2.9f, -0.2f}, {2.9f, 2.9f, 8.3f}, 0.04f);
  expect_limbs(limbs, read(soup.text(6)), 0.5f);
}

TEST_F(ReadTree, AWeldedTreeThatIsOpenAtItsFootStandsOnIt) {
  const std::vector<GrownLimb> limbs = grow_limbs(4, 0);
  // The grid begins above the ground, so that the surface ends there.
  const TriangleSoup soup =
      marched_surface([&](const glm::vec3& p) { return outside_tree(limbs, p); },
                      {-2.9f, -2.9f, 0.1f}, {2.9f, 2.9f, 8.3f}, 0.04f);
  const Skeleton skeleton = read(soup.text(7));
  expect_limbs(limbs, skeleton, 0.5f);
  EXPECT_LT(glm::distance(skeleton.branches[0].points[0], {0, 0, 0.1f}), 0.02f);
  EXPECT_NEAR(skeleton.branches[0].radii[0], 0.3f, 0.03f);
}

TEST_F(ReadTree, AWeldedTreeKeepsItsLeaves) {
  const std::vector<GrownLimb> limbs = grow_limbs(4, 0);
  const TriangleSoup soup =
      marched_surface([&](const glm::vec3& p) { return outside_tree(limbs, p); },
                      {-2.9f, -2.9f, -0.2f}, {2.9f, 2.9f, 8.3f}, 0.04f);
  std::string text = soup.text(8);
  for (int i = 0; i < 3; ++i) {
    const std::string x = "0." + std::to_string(2 * i);
    text +=
        "v " + x + " 2 4\nv " + x + " 2.1 4\nv " + x + "9 2.1 4\nv " + x + "9 2 4\nf -4 -3 -2 -1\n";
  }
  const Skeleton skeleton = read(text);
  EXPECT_EQ(skeleton.branches.size(), 5u);
  EXPECT_EQ(skeleton.report.foliage_parts, 3);
  EXPECT_EQ(skeleton.foliage.leaf_branch.size(), 3u);
}

TEST_F(ReadTree, ABodyWithLegsIsNoTree) {
  // About as thick as a cow.
  std::vector<GrownLimb> limbs{{-1, {-1, 0, 1.5f}, {1, 0, 1.5f}, 0.6f}};
  for (const glm::vec2 foot :
       {glm::vec2(-0.8f, -0.3f), {-0.8f, 0.3f}, {0.5f, -0.3f}, {0.5f, 0.3f}}) {
    limbs.push_back({0, {foot.x, foot.y, 1.3f}, {foot.x, foot.y, 0}, 0.2f});
  }
  const auto field = [&](const glm::vec3& p) { return outside_tree(limbs, p); };
  const TriangleSoup soup = marched_surface(field, {-2, -1, -0.2f}, {2, 1, 2.4f}, 0.07f);
  EXPECT_THAT(error_of(soup.text(9)), HasSubstr("not a tree: its limbs are"));
}

/// A bar of four sides between two points.
void bar(const glm::vec3& from, const glm::vec3& to, float radius, TriangleSoup& soup) {
  const glm::vec3 axis = glm::normalize(to - from);
  const glm::vec3 across = std::abs(axis.z) < 0.9f ? glm::vec3(0, 0, 1) : glm::vec3(1, 0, 0);
  const glm::vec3 u = glm::normalize(glm::cross(axis, across));
  const glm::vec3 w = glm::cross(axis, u);
  std::vector<int32_t> v;
  for (const glm::vec3& end : {from, to}) {
    for (const glm::vec3& corner : {u, w, -u, -w})
      v.push_back(soup.add_vertex(end + radius * corner));
  }
  for (int k = 0; k < 4; ++k) {
    soup.add_triangle(v[k], v[(k + 1) % 4], v[4 + k]);
    soup.add_triangle(v[4 + k], v[(k + 1) % 4], v[4 + (k + 1) % 4]);
  }
  soup.add_triangle(v[0], v[2], v[1]);
  soup.add_triangle(v[0], v[3], v[2]);
  soup.add_triangle(v[4], v[5], v[6]);
  soup.add_triangle(v[4], v[6], v[7]);
}

TriangleSoup bench() {
  TriangleSoup soup;
  for (const float x : {0.0f, 2.0f}) {
    bar({x, 0, 0}, {x, 0, 1}, 0.06f, soup);
    bar({x, 0.5f, 0}, {x, 0.5f, 0.5f}, 0.06f, soup);
    bar({x, 0, 0.5f}, {x, 0.5f, 0.5f}, 0.06f, soup);
  }
  for (const float y : {0.1f, 0.25f, 0.4f}) bar({0, y, 0.5f}, {2, y, 0.5f}, 0.07f, soup);
  for (const float z : {0.7f, 0.9f}) bar({0, 0, z}, {2, 0, z}, 0.07f, soup);
  return soup;
}

TEST_F(ReadTree, ABenchIsNoTree) {
  EXPECT_THAT(error_of("g side\n" + bench().text(10)),
              HasSubstr("pieces are bars, as thick at one end"));
}

TEST_F(ReadTree, WhatIsNearlyAllNoWoodIsNoTree) {
  // The body alone is refused; with two horns it is still not a tree.
  std::vector<GrownLimb> body{{-1, {-1, 0, 1.5f}, {1, 0, 1.5f}, 0.6f}};
  for (const float x : {-0.8f, 0.5f}) body.push_back({0, {x, 0, 1.3f}, {x, 0, 0}, 0.2f});
  const auto field = [&](const glm::vec3& p) { return outside_tree(body, p); };
  TriangleSoup soup = marched_surface(field, {-2, -1, -0.2f}, {2, 1, 2.4f}, 0.07f);
  for (const float y : {-0.3f, 0.3f}) bar({1, y, 2}, {1, 1.5f * y, 2.4f}, 0.05f, soup);
  EXPECT_THAT(error_of("g animal\n" + soup.in_order()),
              HasSubstr("is not wood, its largest part is not a tree: its limbs are"));
}

TEST_F(ReadTree, ATableAndALadderAreNoTrees) {
  TriangleSoup table;
  bar({-1, 0, 0.75f}, {1, 0, 0.75f}, 0.1f, table);
  for (const float x : {-0.9f, 0.9f}) {
    for (const float y : {-0.05f, 0.05f}) bar({x, y, 0.75f}, {x, y, 0}, 0.03f, table);
  }
  EXPECT_THAT(error_of("g table\n" + table.in_order()), HasSubstr("at right angles to each other"));
  TriangleSoup ladder;
  for (const float x : {0.0f, 0.5f}) bar({x, 0, 0}, {x, 0, 3}, 0.04f, ladder);
  for (int i = 0; i < 9; ++i) {
    const float z = 0.3f + 0.3f * static_cast<float>(i);
    bar({0, 0, z}, {0.5f, 0, z}, 0.02f, ladder);
  }
  EXPECT_THAT(error_of("g ladder\n" + ladder.in_order()),
              HasSubstr("at right angles to each other"));
}

TEST_F(ReadTree, BarsAtOtherAnglesMayBeATree) {
  // As drawn by a generator without taper.
  TriangleSoup tree;
  bar({0, 0, 0}, {0, 0, 3}, 0.1f, tree);
  for (int i = 0; i < 6; ++i) {
    const float z = 1.2f + 0.3f * static_cast<float>(i), angle = 2.4f * static_cast<float>(i);
    bar({0, 0, z}, {std::cos(angle), std::sin(angle), z + 0.6f}, 0.03f, tree);
  }
  EXPECT_EQ(error_of("g thing\n" + tree.in_order()), "no error");
}

TEST_F(ReadTree, AHouseOfBlocksIsNoTree) {
  TriangleSoup house;
  bar({0, 0, 0}, {0, 0, 3}, 5.0f, house);
  bar({1, 0, 3}, {1, 0, 5.5f}, 0.4f, house);
  for (const float x : {-2.0f, 0.0f, 2.0f}) bar({x, -3.5f, 1}, {x, -3.5f, 2}, 0.5f, house);
  EXPECT_THAT(error_of("g house\n" + house.text(10)),
              HasSubstr("4 are less than twice as long as they are thick"));
}

TEST_F(ReadTree, WhatIsNamedAsWoodIsBelieved) {
  EXPECT_EQ(error_of("g branches\n" + bench().text(10)), "no error");
  EXPECT_EQ(error_of("g side\n" + bench().text(10), {.levels = "side"}), "no error");
}

TEST_F(ReadTree, WoodThatIsLeftOutIsReportedWithItsShareOfTheArea) {
  TreeText text;
  text.tree(false, numbered);
  text.line("g bark_sheet\nv 0 0 2\nv 1 0 2\nv 1 1 2\nv 0 1 2\nf -4 -3 -2 -1");
  EXPECT_THAT(
      read(text.text()).report.skipped_parts,
      ElementsAre(Pair("bark_sheet", "a single plane, not a limb: 4.2 % of the wood's area")));
}

TEST_F(ReadTree, LevelsFollowWhoStandsOnWhomNotSize) {
  // The limbs are longer and thicker than their parents.
  for (const auto& [trunk, limbs] : {std::pair("trunk", "branch"), std::pair("part_a", "part_b")}) {
    TreeText text;
    text.line(std::string("g ") + trunk + "1");
    text.limb({0, 0, 0}, {0, 0, 1}, 5, 0.3f, true);
    for (int i = 0; i < 4; ++i) {
      text.line(std::string("g ") + limbs + std::to_string(i + 1));
      const float angle = 1.57f * static_cast<float>(i);
      text.limb({0, 0, 1.2f + 0.6f * static_cast<float>(i)},
                {std::cos(angle), std::sin(angle), 0.3f}, 12, 0.29f, true);
    }
    const Skeleton skeleton = read(text.text(), {.up_axis = UpAxis::kZ});
    EXPECT_THAT(skeleton.report.branches_per_level, ElementsAre(1, 4)) << trunk;
    EXPECT_EQ(skeleton.branches[0].name, std::string(trunk) + "1");
    for (int i = 1; i <= 4; ++i) EXPECT_EQ(skeleton.branches[i].parent, 0) << trunk;
  }
}

/// A component of a scene of its own.
struct Piece {
  ObjScene scene;
  std::vector<int32_t> faces, vertices;

  void add_face(const std::vector<int32_t>& corners) {
    scene.corner_vertex.insert(scene.corner_vertex.end(), corners.begin(), corners.end());
    scene.face_begin.push_back(static_cast<int32_t>(scene.corner_vertex.size()));
    faces.push_back(static_cast<int32_t>(faces.size()));
  }
  void add_vertex(const glm::vec3& p) {
    vertices.push_back(static_cast<int32_t>(vertices.size()));
    scene.positions.push_back(p);
  }
  std::optional<Limb> trace() const { return trace_uneven_tube(scene, faces, vertices); }
};

TEST(UnevenTubes, ATubeWoundAsAScrewHasItsAxisForCentreline) {
  constexpr int kAround = 5, kAll = 101;
  Piece piece;
  for (int i = 0; i < kAll; ++i) {
    const double angle = 2.0 * M_PI * i / kAround;
    piece.add_vertex(glm::vec3(0.1 * std::cos(angle), 0.1 * std::sin(angle), 0.02 * i));
  }
  for (int i = 0; i + kAround < kAll; ++i) {
    piece.add_face({i, i + 1, i + kAround});
    if (i + kAround + 1 < kAll) piece.add_face({i + 1, i + kAround + 1, i + kAround});
  }
  piece.add_vertex({0, 0, 2.1f});
  for (int i = kAll - kAround; i + 1 < kAll; ++i) piece.add_face({i, i + 1, kAll});
  piece.add_face({kAll - 1, kAll - kAround, kAll});
  const std::optional<Limb> limb = piece.trace();
  ASSERT_TRUE(limb);
  EXPECT_LT(limb->points.front().z, 0.2f);
  EXPECT_GT(limb->points.back().z, 1.95f);
  for (size_t i = 1; i + 1 < limb->points.size() && limb->points[i].z < 1.85f; ++i) {
    EXPECT_LT(std::hypot(limb->points[i].x, limb->points[i].y), 0.03f) << i;
    EXPECT_NEAR(limb->radii[i], 0.09f, 0.02f) << i;
  }
}

TEST(UnevenTubes, ALeafIsNone) {
  Piece leaf;
  for (int i = 0; i < 7; ++i) {
    leaf.add_vertex({-0.1f, 0, 0.2f * static_cast<float>(i)});
    leaf.add_vertex({0.1f, 0, 0.2f * static_cast<float>(i)});
  }
  for (int i = 0; i < 12; i += 2) leaf.add_face({i, i + 1, i + 3, i + 2});
  EXPECT_FALSE(leaf.trace());
}

TEST(UnevenTubes, ABowlIsNone) {
  Piece bowl;
  for (int i = 0; i < 2; ++i) {
    for (int k = 0; k < 6; ++k) {
      const double angle = M_PI * k / 3.0;
      bowl.add_vertex(glm::vec3(std::cos(angle), std::sin(angle), 0.5 * i));
    }
  }
  bowl.add_vertex({0, 0, 1.2f});
  for (int k = 0; k < 6; ++k) {
    bowl.add_face({k, (k + 1) % 6, 6 + (k + 1) % 6, 6 + k});
    bowl.add_face({6 + k, 6 + (k + 1) % 6, 12});
  }
  EXPECT_FALSE(bowl.trace());
}

/// The surface of unit cubes as one welded mesh.
class Cubes {
 public:
  void fill(glm::ivec3 low, glm::ivec3 high) {
    for (int x = low.x; x < high.x; ++x) {
      for (int y = low.y; y < high.y; ++y) {
        for (int z = low.z; z < high.z; ++z) cubes_.insert({x, y, z});
      }
    }
  }

  std::string text() const {
    std::map<std::array<int, 3>, int> number;
    std::string vertices;
    std::string faces = "g trunk\n";
    for (const auto& [x, y, z] : cubes_) {
      for (int axis = 0; axis < 3; ++axis) {
        for (const int side : {0, 1}) {
          std::array<int, 3> beside{x, y, z};
          beside[axis] += 2 * side - 1;
          if (cubes_.contains(beside)) continue;
          faces += "f";
          for (int c = 0; c < 4; ++c) {
            std::array<int, 3> corner{x, y, z};
            corner[axis] += side;
            const int turn = side == 1 ? c : 3 - c;
            corner[(axis + 1) % 3] += turn == 1 || turn == 2 ? 1 : 0;
            corner[(axis + 2) % 3] += turn >= 2 ? 1 : 0;
            const auto next = static_cast<int>(number.size()) + 1;
            const auto [found, added] = number.try_emplace(corner, next);
            if (added) {
              vertices += "v " + std::to_string(corner[0]) + " " + std::to_string(corner[1]) + " " +
                          std::to_string(corner[2]) + "\n";
            }
            faces += " " + std::to_string(found->second);
          }
          faces += "\n";
        }
      }
    }
    return vertices + faces;
  }

 private:
  std::set<std::array<int, 3>> cubes_;
};

TEST_F(ReadTree, ATreeStartsAboveItsRootsWhichAreBranches) {
  Cubes cubes;
  cubes.fill({0, 0, 0}, {4, 4, 40});
  for (const int z : {0, 30}) {
    const int reach = z == 0 ? 10 : 24;
    cubes.fill({4, 1, z}, {4 + reach, 3, z + 2});
    cubes.fill({-reach, 1, z}, {0, 3, z + 2});
    cubes.fill({1, 4, z}, {3, 4 + reach, z + 2});
    cubes.fill({1, -reach, z}, {3, 0, z + 2});
  }
  ReadTreeOptions options;
  options.up_axis = UpAxis::kZ;
  const Skeleton skeleton = read(cubes.text(), options);
  EXPECT_EQ(skeleton.report.form, "WELDED");
  const Branch& trunk = skeleton.branches[0];
  EXPECT_LT(trunk.points.front().z, 8.0f);
  const glm::vec3 middle = trunk.points[trunk.points.size() / 2];
  EXPECT_GT(middle.z, 15.0f);
  int roots = 0;
  for (const Branch& branch : skeleton.branches) {
    const bool low = branch.points.back().z < 3.0f;
    roots += low ? 1 : 0;
    EXPECT_FALSE(low && branch.parent < 0);
  }
  EXPECT_EQ(roots, 4);
}

}  // namespace
}  // namespace snowbough::tree
