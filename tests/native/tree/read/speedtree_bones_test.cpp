#include "tree/read/speedtree_bones.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

namespace snowbough::tree {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string bone(int id, int parent, const std::string& rest, const std::string& generator = "") {
  return "<Bone ID=\"" + std::to_string(id) + "\" ParentID=\"" + std::to_string(parent) + "\" " +
         rest + " Mass=\"1\" Generator=\"" + generator + "\" />\n";
}

std::string place(const std::string& x, const std::string& z, const std::string& to_x,
                  const std::string& to_z, const std::string& radius = "0.1") {
  return "Radius=\"" + radius + "\" StartX=\"" + x + "\" StartY=\"0\" StartZ=\"" + z +
         "\" EndX=\"" + to_x + "\" EndY=\"0\" EndZ=\"" + to_z + "\"";
}

std::string message_of(const std::string& text) {
  try {
    parse_speedtree_bones(text, "tree.xml");
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

/// A trunk of two bones with a branch at the end of the first, and a second stem.
std::string small_tree() {
  return "<SpeedTreeRaw>\n<Bones Count=\"4\">\n" +
         bone(7, -1, place("0", "0", "0", "2"), "Trunk 1") +
         bone(9, 3, place("0", "2", "1", "2.5", "0.05"), "Branch 4") +
         bone(3, 7, place("0", "2", "0.1", "4"), "Trunk 1") +
         bone(1, -1, place("0.3", "0", "1", "2"), "Trunk 2") + "</Bones>\n</SpeedTreeRaw>\n";
}

TEST(SpeedTreeBones, HaveDecimalPointsOrCommas) {
  const auto bones =
      parse_speedtree_bones(bone(0, -1, place("21,0313", "-2,70936", "1e-2", "4", "0,3048")), "");
  ASSERT_EQ(bones.size(), 1u);
  EXPECT_DOUBLE_EQ(bones[0].start.x, 21.0313);
  EXPECT_DOUBLE_EQ(bones[0].start.z, -2.70936);
  EXPECT_DOUBLE_EQ(bones[0].end.x, 0.01);
  EXPECT_DOUBLE_EQ(bones[0].radius, 0.3048);
}

TEST(SpeedTreeBones, FormBranchesWithOneRoot) {
  const std::vector<Branch> branches = branches_of_bones(parse_speedtree_bones(small_tree(), ""));
  ASSERT_EQ(branches.size(), 3u);
  EXPECT_EQ(branches[0].name, "Trunk_1");
  EXPECT_THAT(branches[0].points,
              ElementsAre(glm::vec3(0, 0, 0), glm::vec3(0, 0, 2), glm::vec3(0.1f, 0, 4)));
  std::vector<int32_t> parents, levels;
  std::vector<std::string> names;
  for (const Branch& branch : branches) {
    parents.push_back(branch.parent);
    levels.push_back(branch.level);
    names.push_back(branch.name);
  }
  EXPECT_THAT(parents, ElementsAre(-1, 0, 0));
  EXPECT_THAT(levels, ElementsAre(0, 1, 1));
  EXPECT_THAT(names, ElementsAre("Trunk_1", "Trunk_2", "Branch_4"));
  EXPECT_EQ(branches[2].attach_point, glm::vec3(0, 0, 2));
}

TEST(SpeedTreeBones, AreRefusedWithFileAndLine) {
  EXPECT_THAT(message_of("<Bones>\n" + bone(0, -1, place("x", "0", "0", "1"))),
              HasSubstr("tree.xml:2: 'x' is no number"));
  EXPECT_THAT(message_of("<Bone ID=\"0\" ParentID=\"-1\" />"), HasSubstr("lacks Radius"));
  EXPECT_THAT(message_of("<Bone ID=\"0\" "), HasSubstr("ends within a bone"));
  EXPECT_THAT(message_of("<SpeedTreeRaw><Bones Count=\"0\"/></SpeedTreeRaw>"),
              HasSubstr("has no bones"));
}

TEST(SpeedTreeBones, AreRefusedWithoutAHierarchy) {
  const std::string up = place("0", "0", "0", "1");
  EXPECT_THAT(message_of(bone(0, 5, up)), HasSubstr("grows from 5, which does not exist"));
  EXPECT_THAT(message_of(bone(2, -1, up) + bone(2, -1, up)), HasSubstr("two bones have the ID 2"));
  EXPECT_THAT(message_of(bone(1, 2, up) + bone(2, 1, up)), HasSubstr("is its own ancestor"));
}

TEST(SpeedTreeBones, FitAMeshInOtherUnitsAndAxes) {
  std::vector<Branch> branches = branches_of_bones(parse_speedtree_bones(small_tree(), ""));
  std::vector<glm::vec3> wood;
  for (int i = 0; i <= 100; ++i) wood.emplace_back(10.0f, 400.0f * i / 100.0f, 0.0f);
  // In centimetres with Y up.
  fit_branches(wood, "tree.xml", branches);
  EXPECT_THAT(branches[0].points.back(), glm::vec3(10.0f, 400.0f, 0.0f));
  EXPECT_FLOAT_EQ(branches[0].radii.front(), 10.0f);
}

}  // namespace
}  // namespace snowbough::tree
