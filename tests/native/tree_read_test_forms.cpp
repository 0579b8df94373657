#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <glm/geometric.hpp>
#include <limits>
#include <sstream>

#include "tree/attach.h"
#include "tree/levels.h"
#include "tree/part_names.h"
#include "tree/read_tree.h"

namespace snowbough::tree {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pair;

/// Writes small trees as OBJ text, Z up: a trunk from z = 0 to 8, limbs along x, y.
class TreeText {
 public:
  /// A square tube, or a row of disconnected squares, from `root` in `step`s.
  void limb(glm::vec3 root, glm::vec3 step, int rings, float radius, bool squares) {
    const glm::vec3 side =
        std::abs(step.z) > 0.5f * glm::length(step) ? glm::vec3(1, 0, 0) : glm::vec3(0, 0, 1);
    const glm::vec3 u = glm::normalize(glm::cross(step, side));
    const glm::vec3 w = glm::normalize(glm::cross(step, u));
    const int first = vertices_ + 1;
    for (int i = 0; i < rings; ++i) {
      const float r = radius * (1.0f - 0.8f * i / rings);
      for (const auto& [a, b] : {std::pair(1, 0), {0, 1}, {-1, 0}, {0, -1}}) {
        const glm::vec3 p = root + step * float(i) + r * (float(a) * u + float(b) * w);
        text_ << "v " << p.x << " " << p.y << " " << p.z << "\n";
        ++vertices_;
      }
    }
    for (int i = 0; i < rings; ++i) {
      const int a = first + 4 * i;
      if (squares) {
        text_ << "f " << a << " " << a + 1 << " " << a + 2 << " " << a + 3 << "\n";
        continue;
      }
      for (int c = 0; c < 4 && i + 1 < rings; ++c) {
        text_ << "f " << a + c << " " << a + (c + 1) % 4 << " " << a + 4 + (c + 1) % 4 << " "
              << a + 4 + c << "\n";
      }
    }
  }

  /// A square leaf from `base` along `along`.
  void leaf(glm::vec3 base, glm::vec3 along) {
    for (const glm::vec3& p : {base, base + along + glm::vec3(0, 0, 0.1f), base + 2.0f * along,
                               base + along - glm::vec3(0, 0, 0.1f)}) {
      text_ << "v " << p.x << " " << p.y << " " << p.z << "\nvt " << p.x << " " << p.y << "\n";
    }
    text_ << "f -4/-4 -3/-3 -2/-2 -1/-1\n";
    vertices_ += 4;
  }

  TreeText& line(const std::string& text) {
    text_ << text << "\n";
    return *this;
  }

  /// A trunk and four limbs, each with a twig; `name(level, number)` gives the line before each.
  template <typename Name>
  void tree(bool squares, const Name& name) {
    line(name(0, 1));
    limb({0, 0, 0}, {0, 0, 1}, 9, 0.5f, squares);
    const glm::vec3 ways[] = {{1, 0, 0.2f}, {0, 1, 0.2f}, {-1, 0, 0.2f}, {0, -1, 0.2f}};
    for (int i = 0; i < 4; ++i) {
      line(name(1, i + 1));
      limb({0, 0, 2.5f + i}, 0.5f * ways[i], 6, 0.2f, squares);
    }
    for (int i = 0; i < 4; ++i) {
      line(name(2, i + 1));
      limb(glm::vec3(0, 0, 2.5f + i) + 1.25f * ways[i], {0.02f, 0.01f, 0.3f}, 4, 0.05f, squares);
    }
  }

  std::string text() const { return text_.str(); }

 private:
  std::ostringstream text_;
  int vertices_ = 0;
};

class ReadTree : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        std::filesystem::path(testing::TempDir()) /
        ("read_tree_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& text) {
    const std::string path = (folder_ / name).string();
    std::ofstream(path, std::ios::binary) << text;
    return path;
  }
  Skeleton read(const std::string& text, const ReadTreeOptions& options = {}) {
    return read_tree(write("tree.obj", text), options);
  }
  std::string error_of(const std::string& text, const ReadTreeOptions& options = {}) {
    try {
      read(text, options);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "no error";
  }

  std::filesystem::path folder_;
};

/// The tree of TreeText::tree: nine branches on three levels, every twig on its limb.
void expect_tree(const Skeleton& skeleton, const std::string& form) {
  EXPECT_EQ(skeleton.report.form, form);
  EXPECT_EQ(skeleton.report.up_axis, "Z");
  EXPECT_THAT(skeleton.report.branches_per_level, ElementsAre(1, 4, 4));
  EXPECT_THAT(skeleton.report.extra_roots, IsEmpty());
  EXPECT_THAT(skeleton.report.skipped_parts, IsEmpty());
  ASSERT_EQ(skeleton.branches.size(), 9u);
  EXPECT_FLOAT_EQ(skeleton.height, 8.0f);
  EXPECT_EQ(skeleton.branches[0].points.size(), 9u);
  EXPECT_NEAR(skeleton.branches[0].radii[0], 0.5f, 1e-5f);
  EXPECT_NEAR(skeleton.branches[0].areas[0], 0.5f, 1e-5f);
  for (int i = 1; i <= 4; ++i) {
    EXPECT_EQ(skeleton.branches[i].parent, 0);
    EXPECT_LT(glm::distance(skeleton.branches[i].attach_point, glm::vec3(0, 0, 1.5f + i)), 1e-5f);
    EXPECT_EQ(skeleton.branches[4 + i].parent, i);
  }
}

std::string numbered(int level, int number) {
  return std::string("g ") +
         (level == 0   ? "trunk"
          : level == 1 ? "branch"
                       : "limb") +
         std::to_string(number);
}

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

TEST_F(ReadTree, LeavesWithoutAnyNamesAreToldByTheirShape) {
  TreeText text;
  text.tree(false, [](int, int) { return ""; });
  for (int i = 0; i < 5; ++i) text.leaf({0.5f, 0.1f, 2.6f + 0.01f * i}, {0.1f, 0.2f, 0});
  const Skeleton skeleton = read(text.text());
  expect_tree(skeleton, "MERGED_TUBES");
  EXPECT_EQ(skeleton.report.foliage_parts, 5);
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
  EXPECT_THAT(error_of(text.text()), HasSubstr("holds no branches, only 7 leaves"));
}

TEST_F(ReadTree, AFileOfUnnamedLeavesSaysSo) {
  TreeText text;
  for (int i = 0; i < 7; ++i) text.leaf({std::sin(2.0f * i), 0, i}, {0.1f, 0.2f, 0});
  EXPECT_THAT(error_of(text.text()), HasSubstr("holds no branches"));
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
        Cancelled);
  }
}

TEST_F(ReadTree, LeavesHangOnTheirTwigAndStayThereWhenItIsSimplified) {
  TreeText text;
  text.tree(false, numbered);
  text.line("g leaves");
  // On limb 1 (along x at z = 2.5 ...) and on twig 3.
  text.leaf({1.5f, 0.15f, 2.8f}, {0.0f, 0.2f, 0});
  text.leaf({-1.25f, 0.1f, 5.2f}, {0.0f, 0.2f, 0});
  for (const Simplify simplify : {Simplify::kNone, Simplify::kThesis}) {
    const Skeleton skeleton = read(text.text(), {.simplify = simplify});
    ASSERT_EQ(skeleton.foliage.leaf_branch.size(), 2u);
    EXPECT_EQ(skeleton.branches[skeleton.foliage.leaf_branch[0]].name, "branch1");
    EXPECT_EQ(skeleton.branches[skeleton.foliage.leaf_branch[1]].name, "limb3");
    EXPECT_LT(glm::distance(skeleton.foliage.leaf_attach_point[0], glm::vec3(1.5f, 0, 2.8f)),
              0.01f);
  }
}

TEST_F(ReadTree, LeavesOnPetiolesHangOnTheTwigTheyPointAt) {
  // Two parallel twigs 0.5 apart; the leaves stand 0.4 away from the right one and only 0.1 from
  // the left one, but point at the right one. No petiole is drawn.
  TreeText text;
  text.line("g trunk");
  text.limb({0, 0, 0}, {1, 0, 0}, 9, 0.2f, false);
  text.line("g twigs");
  text.limb({1, 0, 0}, {0, 0, 1}, 8, 0.02f, false);
  text.limb({1.5f, 0, 0}, {0, 0, 1}, 8, 0.02f, false);
  text.limb({7, 0, 0}, {0, 0, 1}, 8, 0.02f, false);
  text.line("g leaves");
  for (int i = 0; i < 30; ++i) text.leaf({7.4f, 0, 0.2f + 0.2f * i}, {0.2f, 0, 0});
  text.leaf({1.1f, 0, 3}, {-0.2f, 0, 0});
  const Skeleton skeleton = read(text.text(), {.up_axis = UpAxis::kZ});
  ASSERT_EQ(skeleton.foliage.leaf_branch.size(), 31u);
  EXPECT_EQ(skeleton.branches[skeleton.foliage.leaf_branch[30]].name, "twigs_2");
}

TEST_F(ReadTree, FoliageKeepsGeometryUvsAndMaterials) {
  TreeText text;
  text.line("mtllib my leaves.mtl");
  text.tree(false, numbered);
  text.line("g leaves\nusemtl Leaf A");
  text.leaf({0.5f, 0.1f, 2.6f}, {0.1f, 0.2f, 0});
  text.line("usemtl Leaf B");
  text.leaf({0.5f, 0.1f, 2.7f}, {0.1f, 0.2f, 0});
  std::filesystem::create_directories(folder_ / "textures");
  write("my leaves.mtl",
        "newmtl Leaf A\nKd 0.1 0.5 0.2\nd 0.75\nmap_Kd -s 1 1 1 C:\\art\\Leaf Green.PNG\nmap_d "
        "alpha.png\n"
        "newmtl Leaf B\nKd x\nmap_Kd missing one.png\n");
  write("textures/leaf green.png", "");
  write("alpha.png", "");
  const Skeleton skeleton = read(text.text());
  const Foliage& foliage = skeleton.foliage;
  EXPECT_THAT(foliage.face_begin, ElementsAre(0, 4, 8));
  EXPECT_EQ(foliage.vertices[0], glm::vec3(0.5f, 0.1f, 2.6f));
  EXPECT_EQ(foliage.corner_uv[0], glm::vec2(0.5f, 0.1f));
  EXPECT_THAT(foliage.face_material, ElementsAre(0, 1));
  EXPECT_THAT(foliage.face_leaf, ElementsAre(0, 1));
  ASSERT_EQ(foliage.materials.size(), 2u);
  EXPECT_EQ(foliage.materials[0].diffuse, glm::vec3(0.1f, 0.5f, 0.2f));
  EXPECT_FLOAT_EQ(foliage.materials[0].opacity, 0.75f);
  EXPECT_THAT(foliage.materials[0].diffuse_texture, testing::EndsWith("textures/leaf green.png"));
  EXPECT_THAT(foliage.materials[0].alpha_texture, testing::EndsWith("/alpha.png"));
  EXPECT_THAT(
      skeleton.report.warnings,
      testing::UnorderedElementsAre(HasSubstr("my leaves.mtl:7: malformed Kd"),
                                    HasSubstr("texture 'missing one.png' of material 'Leaf B'")));
}

TEST_F(ReadTree, AMissingLibraryIsAWarning) {
  TreeText text;
  text.line("mtllib gone.mtl");
  text.tree(false, numbered);
  EXPECT_THAT(read(text.text()).report.warnings, ElementsAre(HasSubstr("'gone.mtl' is missing")));
}

TEST_F(ReadTree, FoliageCanBeLeftOut) {
  TreeText text;
  text.tree(false, numbered);
  text.line("g leaves");
  text.leaf({0.5f, 0.1f, 2.6f}, {0.1f, 0.2f, 0});
  const Skeleton skeleton = read(text.text(), {.foliage = false});
  EXPECT_TRUE(skeleton.foliage.vertices.empty());
  EXPECT_EQ(skeleton.report.foliage_parts, 1);
  EXPECT_THAT(skeleton.report.skipped_parts,
              Contains(Pair(HasSubstr("foliage"), "left out by option")));
}

TEST_F(ReadTree, FoliageIsWhatTheUserNames) {
  TreeText text;
  text.tree(false, numbered);
  text.line("g leaves");
  text.leaf({0.5f, 0.1f, 2.6f}, {0.1f, 0.2f, 0});
  text.line("g Tags 1\nusemtl paper");
  text.leaf({0.5f, 0.1f, 2.7f}, {0.1f, 0.2f, 0});
  for (const char* names : {"tags", " Paper ", "tags,paper"}) {
    const Skeleton skeleton = read(text.text(), {.foliage_names = names});
    EXPECT_EQ(skeleton.report.foliage_parts, 1) << names;
    EXPECT_EQ(skeleton.foliage.vertices[0].z, 2.7f) << names;
    EXPECT_THAT(skeleton.report.skipped_parts,
                Contains(Pair("leaves", "no limb, and not named as foliage")))
        << names;
  }
  EXPECT_EQ(read(text.text(), {.foliage_names = "leaves,tags"}).report.foliage_parts, 2);
}

TEST_F(ReadTree, FoliageNamesThatMeanNothingAreRefused) {
  TreeText text;
  text.tree(false, numbered);
  EXPECT_THROW(read(text.text(), {.foliage_names = "tags"}), std::invalid_argument);
  EXPECT_THROW(read(text.text(), {.foliage_names = "trunk,,twig"}), std::invalid_argument);
}

Branch tapering(std::string name, std::vector<glm::vec3> points, float radius) {
  Branch branch;
  branch.name = std::move(name);
  branch.level = -1;
  branch.points = std::move(points);
  branch.radii.assign(branch.points.size(), radius);
  branch.radii.back() = 0.5f * radius;
  branch.areas.assign(branch.points.size(), radius * radius);
  return branch;
}

TEST(Attach, TheNearestSegmentCountsNotTheNearestPoint) {
  std::vector<Branch> branches{tapering("trunk", {{0, 0, 0}, {0, 0, 10}}, 0.5f),
                               tapering("limb", {{0, 0, 5}, {2, 0, 4.8f}}, 0.3f),
                               tapering("twig", {{0.1f, 0, 5.1f}, {0.1f, 1, 5.2f}}, 0.1f)};
  std::vector<char> reversible(3, 0);
  attach_branches(branches, reversible, 10.0f);
  EXPECT_EQ(branches[2].name, "twig");
  EXPECT_EQ(branches[2].parent, 0);
  EXPECT_LT(glm::distance(branches[2].attach_point, glm::vec3(0, 0, 5.1f)), 1e-6f);
}

TEST(Attach, BranchesThatStartAtOnePlaceAreSiblings) {
  std::vector<Branch> branches{tapering("trunk", {{0, 0, 0}, {0, 0, 10}}, 0.5f),
                               tapering("left", {{0.1f, 0, 10}, {2, 0, 11}}, 0.3f),
                               tapering("right", {{0.1f, 0, 10}, {-2, 0, 11}}, 0.2f)};
  std::vector<char> reversible(3, 0);
  attach_branches(branches, reversible, 11.0f);
  EXPECT_EQ(branches[2].parent, 0);
}

TEST(Attach, AReversibleLimbIsTurnedRoundWhereItsTipTouches) {
  std::vector<Branch> branches{tapering("trunk", {{0, 0, 0}, {0, 0, 10}}, 0.5f),
                               tapering("limb", {{3, 0, 6}, {0.2f, 0, 5}}, 0.1f)};
  std::vector<char> reversible{0, 1};
  attach_branches(branches, reversible, 10.0f);
  EXPECT_EQ(branches[1].points[0], glm::vec3(0.2f, 0, 5));
  EXPECT_EQ(branches[1].parent, 0);
}

TEST(Attach, AThickStubOnAThinLimbStillFindsIt) {
  std::vector<Branch> branches{tapering("trunk", {{0, 0, 0}, {0, 0, 10}}, 0.5f),
                               tapering("limb", {{0, 0, 5}, {3, 0, 5}}, 0.05f),
                               tapering("stub", {{2.9f, 0, 5}, {2.9f, 0.3f, 5}}, 0.1f)};
  std::vector<char> reversible(3, 0);
  attach_branches(branches, reversible, 10.0f);
  EXPECT_EQ(branches[2].name, "stub");
  EXPECT_EQ(branches[2].parent, 1);
  EXPECT_EQ(branches[2].level, 2);
}

TEST(Levels, ClusterByWhatNamesHaveInCommon) {
  const LevelClusters clusters =
      cluster_labels({"trunk1", "branch1", "branch2", "limb_07", "limb_12"});
  EXPECT_THAT(clusters.names, ElementsAre("trunk", "branch", "limb_"));
  EXPECT_THAT(clusters.cluster, ElementsAre(0, 1, 1, 2, 2));
}

TEST(Levels, DigitsBelongToTheLevelWhereTheRestCountsUp) {
  const LevelClusters clusters =
      cluster_labels({"Branch11", "Branch12", "Branch13", "Branch21", "Branch22"});
  EXPECT_THAT(clusters.names, ElementsAre("Branch1", "Branch2"));
}

TEST(Levels, APlainCountIsOneLevel) {
  std::vector<std::string> labels;
  for (int i = 1; i <= 25; ++i) labels.push_back("twig" + std::to_string(i));
  EXPECT_THAT(cluster_labels(labels).names, ElementsAre("twig"));
}

TEST(Levels, TheLongestNameWinsWhateverItsCase) {
  const LevelClusters clusters = match_levels("Branch,Branch1", {"branch12", "BRANCH3", "leaf"});
  EXPECT_THAT(clusters.cluster, ElementsAre(1, 0, -1));
}

TEST(PartNames, TheLastWordCounts) {
  EXPECT_EQ(meaning_of_name("Dogwood_Leaf.001"), NameMeaning::kFoliage);
  EXPECT_EQ(meaning_of_name("leaf_stem"), NameMeaning::kWood);
  EXPECT_EQ(meaning_of_name("AL06lef1"), NameMeaning::kFoliage);
  EXPECT_EQ(meaning_of_name("left_side"), NameMeaning::kSilent);
  EXPECT_EQ(meaning_of_name("default"), NameMeaning::kSilent);
}

TEST(CompleteSkeleton, RejectsWhatIsNoSkeleton) {
  const auto error = [](const std::function<void(Branch&)>& spoil) -> std::string {
    Skeleton skeleton;
    skeleton.branches = {tapering("a", {{0, 0, 0}, {0, 0, 1}}, 0.1f)};
    skeleton.branches[0].level = 0;
    spoil(skeleton.branches[0]);
    try {
      complete_skeleton(skeleton);
    } catch (const std::invalid_argument& e) {
      return e.what();
    }
    return "no error";
  };
  EXPECT_EQ(error([](Branch&) {}), "no error");
  EXPECT_THAT(error([](Branch& b) { b.points.clear(); }), HasSubstr("('a') has no points"));
  EXPECT_THAT(error([](Branch& b) { b.radii.pop_back(); }), HasSubstr("as many radii"));
  EXPECT_THAT(error([](Branch& b) { b.areas.pop_back(); }), HasSubstr("as many areas"));
  EXPECT_THAT(error([](Branch& b) { b.radii[0] = -1.0f; }), HasSubstr("negative"));
  EXPECT_THAT(error([](Branch& b) { b.points[0].x = std::numeric_limits<float>::quiet_NaN(); }),
              HasSubstr("not finite"));
  EXPECT_THAT(error([](Branch& b) { b.parent = 0; }), HasSubstr("after its parent"));
  EXPECT_THAT(error([](Branch& b) { b.level = -1; }), HasSubstr("level"));
}

TEST(CompleteSkeleton, MakesNamesUnique) {
  Skeleton skeleton;
  for (const char* name : {"a", "a", "a_2", ""}) {
    skeleton.branches.push_back(tapering(name, {{0, 0, 0}, {0, 0, 1}}, 0.1f));
    skeleton.branches.back().level = 0;
  }
  complete_skeleton(skeleton);
  EXPECT_EQ(skeleton.branches[1].name, "a_3");
  EXPECT_EQ(skeleton.branches[2].name, "a_2");
  EXPECT_EQ(skeleton.branches[3].name, "branch");
}

}  // namespace
}  // namespace snowbough::tree
