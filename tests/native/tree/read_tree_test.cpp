#include "tree/read_tree.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <sstream>

#include "native/tree/tree_text.h"

namespace snowbough::tree {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pair;

TEST_F(ReadTree, Form1SquaresPerGroup) {
  TreeText text;
  text.tree(true, numbered);
  const Skeleton skeleton = read(text.text());
  expect_tree(skeleton, "SQUARES_PER_GROUP");
  EXPECT_EQ(skeleton.branches[3].name, "branch3");
}

TEST_F(ReadTree, Form2TubesPerGroup) {
  TreeText text;
  text.tree(false, numbered);
  expect_tree(read(text.text()), "TUBES_PER_GROUP");
}

TEST_F(ReadTree, Form2TubesPerObject) {
  TreeText text;
  text.tree(false, [](int level, int number) { return "o" + numbered(level, number).substr(1); });
  expect_tree(read(text.text()), "TUBES_PER_GROUP");
}

TEST_F(ReadTree, Form3TubesPerLevel) {
  TreeText text;
  text.tree(false, [](int level, int) { return "g stems_" + std::to_string(level); });
  const Skeleton skeleton = read(text.text());
  expect_tree(skeleton, "TUBES_PER_LEVEL");
  EXPECT_EQ(skeleton.branches[2].name, "stems_1_2");
}

TEST_F(ReadTree, Form4MergedTubes) {
  TreeText text;
  text.tree(false, [](int, int) { return ""; });
  const Skeleton skeleton = read(text.text());
  expect_tree(skeleton, "MERGED_TUBES");
  EXPECT_EQ(skeleton.branches[0].name, "trunk");
  EXPECT_EQ(skeleton.branches[5].name, "branch2_1");
}

TEST_F(ReadTree, Form5Materials) {
  TreeText text;
  text.tree(false, [](int, int) { return "usemtl AB12brk1"; });
  text.line("usemtl AB12lef1");
  for (int i = 0; i < 20; ++i) text.leaf({0.5f, 0.1f, 2.6f + 0.01f * i}, {0.1f, 0.2f, 0});
  const Skeleton skeleton = read(text.text());
  expect_tree(skeleton, "MATERIALS");
  EXPECT_EQ(skeleton.report.foliage_parts, 20);
  ASSERT_EQ(skeleton.foliage.materials.size(), 1u);
  EXPECT_EQ(skeleton.foliage.materials[0].name, "AB12lef1");
}

TEST_F(ReadTree, Form6MergedSquares) {
  TreeText text;
  text.tree(true, [](int, int) { return ""; });
  expect_tree(read(text.text()), "MERGED_SQUARES");
}

/// A pole of 30 squares as OBJ text, every `step`th after the other.
std::string pole_of_squares(int step) {
  std::string text;
  for (int i = 0; i < 30; ++i) {
    for (const char* corner : {"1 0 ", "0 1 ", "-1 0 ", "0 -1 "}) {
      text.append("v ").append(corner).append(std::to_string(i)).append("\n");
    }
  }
  text.append("g trunk1\n");
  for (int i = 0; i < 30; ++i) {
    text.append("f");
    for (int c = 1; c <= 4; ++c) {
      text.append(" ").append(std::to_string(4 * (step * i % 30) + c));
    }
    text.append("\n");
  }
  return text;
}

TEST_F(ReadTree, SquaresInRandomOrderAreAWarning) {
  EXPECT_THAT(read(pole_of_squares(1)).report.warnings, IsEmpty());
  EXPECT_THAT(read(pole_of_squares(13)).report.warnings, Contains(HasSubstr("in random order")));
}

/// The same OBJ text with vertices of its own for every corner of every face.
std::string without_common_vertices(const std::string& text) {
  std::istringstream lines(text);
  std::vector<std::string> vertices;
  std::string result;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("v ")) {
      vertices.push_back(line);
    } else if (line.starts_with("f ")) {
      std::istringstream corners(line.substr(2));
      std::string face = "f";
      int count = 0;
      for (int corner = 0; corners >> corner; ++count) result += vertices.at(corner - 1) + "\n";
      for (int c = count; c > 0; --c) face += " -" + std::to_string(c);
      result += face + "\n";
    } else {
      result += line + "\n";
    }
  }
  return result;
}

TEST_F(ReadTree, TubesWhoseFacesShareNoVertexAreTheSameTree) {
  TreeText merged;
  merged.tree(false, [](int, int) { return ""; });
  expect_tree(read(without_common_vertices(merged.text())), "MERGED_TUBES");
  TreeText grouped;
  grouped.tree(false, numbered);
  expect_tree(read(without_common_vertices(grouped.text())), "TUBES_PER_GROUP");
}

TEST_F(ReadTree, SquaresAreNotTakenForTubesOfLooseFaces) {
  TreeText text;
  text.tree(true, numbered);
  expect_tree(read(without_common_vertices(text.text())), "SQUARES_PER_GROUP");
}

TEST_F(ReadTree, LeavesWithoutAnyNamesAreRecognisedByTheirShape) {
  TreeText text;
  text.tree(false, [](int, int) { return ""; });
  for (int i = 0; i < 5; ++i) text.leaf({0.5f, 0.1f, 2.6f + 0.01f * i}, {0.1f, 0.2f, 0});
  const Skeleton skeleton = read(text.text());
  expect_tree(skeleton, "MERGED_TUBES");
  EXPECT_EQ(skeleton.report.foliage_parts, 5);
}

/// A trunk along Y with two leaves; the second leaf's corners have the normal `normal`.
std::string leaves_with_normal(const std::string& normal) {
  std::string text = "g trunk\n";
  for (int i = 0; i < 4; ++i) {
    const std::string y = std::to_string(i);
    for (const char* corner : {"0.1 Y 0", "0 Y -0.1", "-0.1 Y 0", "0 Y 0.1"}) {
      text += "v " + std::string(corner).replace(std::string(corner).find('Y'), 1, y) + "\n";
    }
    for (int c = 1; c <= 4 && i < 3; ++c) {
      const auto corner = [&](int row, int at) {
        return std::to_string(4 * row + (at - 1) % 4 + 1);
      };
      text += "f " + corner(i, c) + " " + corner(i, c + 1) + " " + corner(i + 1, c + 1) + " " +
              corner(i + 1, c) + "\n";
    }
  }
  text += "g leaves\nv 0 2 0\nv 1 2 0\nv 1 2 -1\nv 0 2.5 0\nv 1 2.5 0\nv 1 2.5 -1\nvn 0 1 0\n";
  return text + "vn " + normal + "\nf 17//1 18//1 19//1\nf 20//2 21//2 22\n";
}

TEST_F(ReadTree, LeavesKeepTheirNormals) {
  const Foliage foliage = read(leaves_with_normal("3 4 0")).foliage;
  ASSERT_EQ(foliage.corner_normal.size(), 6u);
  EXPECT_EQ(foliage.corner_normal[0], glm::vec3(0, 0, 1));  // turned from Y up, as the leaves
  EXPECT_LT(glm::distance(foliage.corner_normal[3], glm::vec3(0.6f, 0, 0.8f)), 1e-6f);
  EXPECT_EQ(foliage.corner_normal[5], glm::vec3(0));
}

TEST_F(ReadTree, NormalsOfFlatLeavesNeedNotBeKept) {
  EXPECT_THAT(read(leaves_with_normal("0 2 0.001")).foliage.corner_normal, IsEmpty());
}

TEST_F(ReadTree, SquaresAndLeavesInOneFile) {
  TreeText text;
  text.tree(true, numbered);
  text.line("g leaves");
  for (int i = 0; i < 5; ++i) text.leaf({0.5f, 0.1f, 2.6f + 0.01f * i}, {0.1f, 0.2f, 0});
  const Skeleton skeleton = read(text.text());
  expect_tree(skeleton, "SQUARES_PER_GROUP");
  EXPECT_EQ(skeleton.report.foliage_parts, 5);
}

TEST_F(ReadTree, LevelNamesMayEndInDigits) {
  TreeText text;
  text.tree(true, [](int level, int number) {
    return "g Branch" + std::to_string(level) + std::to_string(number);
  });
  expect_tree(read(text.text()), "SQUARES_PER_GROUP");
}

TEST_F(ReadTree, TheUsersLevelsOverruleTheShape) {
  TreeText text;
  text.tree(true, numbered);
  const Skeleton skeleton = read(text.text(), {.levels = "trunk, limb, branch"});
  EXPECT_THAT(skeleton.report.branches_per_level, ElementsAre(1, 4, 4));
  EXPECT_THAT(skeleton.branches[1].name, testing::StartsWith("limb"));
}

TEST_F(ReadTree, LevelsThatMatchNothingNameTheGroupsThereAre) {
  TreeText text;
  text.tree(true, numbered);
  EXPECT_THAT(error_of(text.text(), {.levels = "stem"}), HasSubstr("'trunk1'"));
  EXPECT_THAT(error_of(text.text(), {.levels = "trunk,,limb"}), HasSubstr("empty"));
  EXPECT_THAT(error_of(text.text(), {.levels = "trunk,limb,trunk"}), HasSubstr("twice"));
}

TEST_F(ReadTree, NamesThatTellNoLevelsGiveWayToThickness) {
  // Groups by side of the tree instead of by level.
  TreeText text;
  text.tree(false, [](int level, int number) {
    return level == 0 || number % 2 == 0 ? "g east" : "g west";
  });
  const Skeleton skeleton = read(text.text());
  EXPECT_EQ(skeleton.branches.size(), 9u);
  EXPECT_THAT(skeleton.report.extra_roots, IsEmpty());
}

TEST_F(ReadTree, YUpIsTurned) {
  TreeText text;
  text.limb({0, 0, 0}, {0, 1, 0}, 9, 0.5f, false);
  text.limb({0, 4, 0}, {0, 0, 1}, 4, 0.2f, false);
  const Skeleton skeleton = read(text.text());
  EXPECT_EQ(skeleton.report.up_axis, "Y");
  EXPECT_LT(glm::distance(skeleton.branches[0].points[8], glm::vec3(0, 0, 8)), 1e-5f);
  EXPECT_LT(glm::distance(skeleton.branches[1].points[3], glm::vec3(0, -3, 4)), 1e-5f);
}

TEST_F(ReadTree, TheUpAxisCanBeSet) {
  TreeText text;
  text.limb({0, 0, 0}, {0, 1, 0}, 9, 0.5f, false);
  EXPECT_LT(glm::distance(read(text.text(), {.up_axis = UpAxis::kZ}).branches[0].points[8],
                          glm::vec3(0, 8, 0)),
            1e-5f);
}

TEST_F(ReadTree, APartThatReachesNoParentIsAnExtraRoot) {
  TreeText text;
  text.tree(false, numbered);
  text.line("g limb9");
  text.limb({4, 4, 7}, {0.1f, 0, 0.3f}, 4, 0.05f, false);
  const Skeleton skeleton = read(text.text());
  EXPECT_THAT(skeleton.report.extra_roots, ElementsAre("limb9"));
}

TEST_F(ReadTree, ASecondStemBesideTheFirstIsARoot) {
  TreeText text;
  text.limb({0, 0, 0}, {0, 0, 1}, 9, 0.3f, false);
  text.limb({0.8f, 0, 0}, {0, 0, 1}, 8, 0.25f, false);
  const Skeleton skeleton = read(text.text());
  EXPECT_THAT(skeleton.report.branches_per_level, ElementsAre(2));
}

TEST_F(ReadTree, SkippedPartsAreReported) {
  TreeText text;
  text.tree(false, numbered);
  text.line("g bark_sheet\nv 9 9 9\nv 9 8 9\nv 8 9 9\nf -1 -2 -3\nf 1 2\nl 1 2");
  const auto skipped = read(text.text()).report.skipped_parts;
  EXPECT_THAT(skipped, Contains(Pair("bark_sheet", HasSubstr("plane"))));
  EXPECT_THAT(skipped, Contains(Pair("(faces)", HasSubstr("1 faces"))));
  EXPECT_THAT(skipped, Contains(Pair("(lines and points)", HasSubstr("1 line"))));
}

TEST_F(ReadTree, AFileOfLeavesSaysSo) {
  TreeText text;
  text.line("g leaves");
  for (int i = 0; i < 7; ++i) text.leaf({0, 0, i}, {0.1f, 0.2f, 0});
  EXPECT_THAT(error_of(text.text()), HasSubstr("has no branches, only 7 leaves"));
}

TEST_F(ReadTree, AFileOfUnnamedLeavesSaysSo) {
  TreeText text;
  for (int i = 0; i < 7; ++i) text.leaf({std::sin(2.0f * i), 0, i}, {0.1f, 0.2f, 0});
  EXPECT_THAT(error_of(text.text()), HasSubstr("has no branches"));
}

TEST_F(ReadTree, GivesTheSameWithATinyBuffer) {
  TreeText text;
  text.tree(false, numbered);
  const Skeleton whole = read(text.text());
  const Skeleton cut = read(text.text(), {.buffer_size = 5});
  ASSERT_EQ(cut.branches.size(), whole.branches.size());
  for (size_t b = 0; b < cut.branches.size(); ++b) {
    EXPECT_EQ(cut.branches[b].points, whole.branches[b].points);
  }
}

TEST_F(ReadTree, ReportsProgressFromNothingToAllAndStopsWhenAsked) {
  TreeText text;
  text.tree(false, numbered);
  std::vector<float> shares;
  read(text.text(), {.buffer_size = 256, .progress = [&](float share) {
                       shares.push_back(share);
                       return true;
                     }});
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_FLOAT_EQ(shares.back(), 1.0f);
  for (size_t stop = 0; stop < shares.size(); ++stop) {
    size_t calls = 0;
    EXPECT_THROW(
        read(text.text(), {.buffer_size = 256, .progress = [&](float) { return calls++ < stop; }}),
        base::Cancelled);
  }
}

}  // namespace
}  // namespace snowbough::tree
