#include "tree/rings/loose_squares.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <glm/geometric.hpp>
#include <random>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "native/tree/rings/sections.h"
#include "tree/read_tree.h"

namespace snowbough::tree {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

template <typename T>
std::vector<T> in_order(const std::vector<T>& all, const std::vector<size_t>& order) {
  std::vector<T> result;
  for (const size_t i : order) result.push_back(all[i]);
  return result;
}

TEST(LooseSquares, TurnsThatGoBackAreCounted) {
  const std::vector<CrossSection> sections = pole(5);
  EXPECT_EQ(count_turns(sections).all, 3u);
  EXPECT_EQ(count_turns(sections).back, 0u);
  // 0, 3, 1, 4, 2: up, down, up, down.
  const Turns turns = count_turns(in_order(sections, {0, 3, 1, 4, 2}));
  EXPECT_EQ(turns.back, 3u);
  EXPECT_TRUE(turns.shuffled());
  EXPECT_FALSE(count_turns(sections).shuffled());
}

/// A comb: short limbs out of one line, one after the other. Half of the turns go back, and more.
std::vector<CrossSection> comb() {
  std::vector<CrossSection> sections;
  for (int limb = 0; limb < 8; ++limb) {
    for (int i = 0; i < 3; ++i) {
      sections.push_back(square_across({i, 0, 0.4f * limb}, {1, 0, 0}, 0.1f));
    }
  }
  return sections;
}

TEST(LooseSquares, NeighboursInTheFileAreNeighboursAlongShortLimbsInOrder) {
  EXPECT_TRUE(count_turns(comb()).shuffled());
  EXPECT_GT(neighbour_share(chain_loose_sections(comb())), 0.9);
  std::vector<size_t> order(comb().size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = (7 * i) % order.size();
  EXPECT_EQ(neighbour_share(chain_loose_sections(in_order(comb(), order))), 0.0);
}

TEST(LooseSquares, OneLimbIsPutInOrderFromItsThickEnd) {
  const std::vector<size_t> order = {4, 0, 5, 2, 7, 1, 6, 3};
  const std::vector<size_t> found = order_one_limb(in_order(pole(8), order));
  EXPECT_THAT(in_order(order, found), ElementsAre(0, 1, 2, 3, 4, 5, 6, 7));
}

TEST(LooseSquares, ALimbThatBendsBackIsFollowedRound) {
  // A hook: up, over and down again beside the way up.
  const std::vector<glm::vec3> points = {{0, 0, 0},       {0, 0, 1},       {0, 0, 2},
                                         {0.4f, 0, 2.7f}, {1.1f, 0, 2.7f}, {1.5f, 0, 2},
                                         {1.5f, 0, 1},    {1.5f, 0, 0.2f}};
  std::vector<CrossSection> sections;
  for (size_t i = 0; i < points.size(); ++i) {
    const glm::vec3 along = points[std::min(i + 1, points.size() - 1)] - points[i > 0 ? i - 1 : 0];
    sections.push_back(square_across(points[i], along, 0.2f - 0.02f * i));
  }
  const std::vector<size_t> order = {6, 1, 4, 0, 7, 3, 2, 5};
  EXPECT_THAT(in_order(order, order_one_limb(in_order(sections, order))),
              ElementsAre(0, 1, 2, 3, 4, 5, 6, 7));
}

TEST(LooseSquares, TwoLimbsSideBySideStayTwo) {
  std::vector<CrossSection> sections = pole(5);
  for (int i = 0; i < 5; ++i) {
    sections.push_back(square_across({0.7f, 0, i + 0.5f}, {0, 0, 1}, 0.3f - 0.05f * i));
  }
  const std::vector<size_t> order = {9, 3, 5, 0, 7, 2, 8, 1, 4, 6};
  const auto rows = chain_loose_sections(in_order(sections, order));
  ASSERT_THAT(rows, SizeIs(2));
  std::vector<std::vector<size_t>> found = {in_order(order, rows[0]), in_order(order, rows[1])};
  std::sort(found.begin(), found.end());
  EXPECT_THAT(found[0], ElementsAre(0, 1, 2, 3, 4));
  EXPECT_THAT(found[1], ElementsAre(5, 6, 7, 8, 9));
}

TEST(LooseSquares, ATwigsRootInTheLimbsWayDoesNotCutTheLimb) {
  // Its root stands between the pole's squares 2 and 3, on the pole's own line.
  std::vector<CrossSection> sections = pole(6);
  for (int i = 0; i < 4; ++i) {
    const glm::vec3 along = glm::normalize(glm::vec3(1, 0, 0.6f));
    sections.push_back(
        square_across(glm::vec3(0, 0, 2.4f) + 0.8f * i * along, along, 0.2f - 0.04f * i));
  }
  std::vector<size_t> order = {7, 2, 9, 4, 0, 6, 3, 8, 5, 1};
  std::vector<std::vector<size_t>> found;
  for (const auto& row : chain_loose_sections(in_order(sections, order))) {
    found.push_back(in_order(order, row));
  }
  std::sort(found.begin(), found.end());
  ASSERT_THAT(found, SizeIs(2));
  EXPECT_THAT(found[0], ElementsAre(0, 1, 2, 3, 4, 5));
  EXPECT_THAT(found[1], ElementsAre(6, 7, 8, 9));
}

TEST(LooseSquares, APlaneFarFromAllIsARowOfItsOwn) {
  std::vector<CrossSection> sections = pole(4);
  sections.push_back(square_across({0.3f, 0, 40}, {0, 0, 1}, 0.3f));
  const auto rows = chain_loose_sections(sections);
  ASSERT_THAT(rows, SizeIs(2));
  EXPECT_THAT(rows, Contains(ElementsAre(4u)));
}

TEST(LooseSquares, LeavesInDisorderDoNotStandSquarelyInRows) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
    std::vector<CrossSection> leaves;
    while (leaves.size() < 300) {
      const glm::vec3 at(unit(random), unit(random), unit(random));
      const glm::vec3 facing(unit(random), unit(random), unit(random));
      if (glm::length(facing) < 0.1f) continue;
      leaves.push_back(square_across(at, facing, 0.05f));
    }
    EXPECT_TRUE(count_turns(leaves).shuffled());
    const double share = square_share(leaves, chain_loose_sections(leaves));
    EXPECT_LT(share, 0.5);
  }
  EXPECT_EQ(square_share(pole(6), chain_loose_sections(pole(6))), 1.0);
}

/// A trunk of nine squares and four limbs of six, by hand; every square is one line.
struct SquareTree {
  std::vector<std::string> faces;
  std::vector<std::string> names;
  std::ostringstream vertices;
  int count = 0;

  SquareTree() {
    limb("trunk1", {0, 0, 0}, {0, 0, 1}, 9, 0.5f);
    const glm::vec3 ways[] = {{1, 0, 0.2f}, {0, 1, 0.2f}, {-1, 0, 0.2f}, {0, -1, 0.2f}};
    for (int i = 0; i < 4; ++i) {
      limb(std::string("branch").append(std::to_string(i + 1)), {0, 0, 2.5f + i}, 0.5f * ways[i], 6,
           0.2f);
    }
  }
  void limb(const std::string& name, glm::vec3 root, glm::vec3 step, int squares, float radius) {
    for (int i = 0; i < squares; ++i) {
      const CrossSection section = square_across(root + step * static_cast<float>(i), step,
                                                 radius * (1.0f - 0.8f * i / squares));
      for (const glm::vec3& p : section.corners) {
        vertices << "v " << p.x << " " << p.y << " " << p.z << "\n";
      }
      std::ostringstream face;
      face << "f " << count + 1 << " " << count + 2 << " " << count + 3 << " " << count + 4 << "\n";
      faces.push_back(face.str());
      names.push_back("g " + name + "\n");
      count += 4;
    }
  }
  std::string shuffled(unsigned seed, bool with_names) const {
    std::vector<size_t> order(faces.size());
    for (size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::mt19937 random(seed);
    for (size_t i = order.size() - 1; i > 0; --i) std::swap(order[i], order[random() % (i + 1)]);
    std::string text = vertices.str();
    for (const size_t i : order) text += (with_names ? names[i] : "") + faces[i];
    return text;
  }
};

Skeleton read_text(const std::string& text) {
  const std::filesystem::path path =
      std::filesystem::path(testing::TempDir()) /
      (std::string(testing::UnitTest::GetInstance()->current_test_info()->name()) + ".obj");
  std::ofstream(path, std::ios::binary) << text;
  Skeleton skeleton = read_tree(path.string());
  std::filesystem::remove(path);
  return skeleton;
}

void expect_square_tree(const Skeleton& skeleton, const std::string& form) {
  EXPECT_EQ(skeleton.report.form, form);
  EXPECT_THAT(skeleton.report.branches_per_level, ElementsAre(1, 4));
  EXPECT_THAT(skeleton.report.extra_roots, IsEmpty());
  EXPECT_THAT(skeleton.report.skipped_parts, IsEmpty());
  EXPECT_THAT(skeleton.report.warnings, Contains(HasSubstr("in random order")));
  ASSERT_THAT(skeleton.branches, SizeIs(5));
  ASSERT_THAT(skeleton.branches[0].points, SizeIs(9));
  for (int i = 0; i < 9; ++i) {
    EXPECT_LT(glm::distance(skeleton.branches[0].points[i], glm::vec3(0, 0, i)), 1e-5f);
  }
  for (int b = 1; b < 5; ++b) {
    EXPECT_EQ(skeleton.branches[b].parent, 0);
    ASSERT_THAT(skeleton.branches[b].points, SizeIs(6));
    EXPECT_NEAR(skeleton.branches[b].radii[0], 0.2f, 1e-5f);
  }
}

TEST(LooseSquares, AMergedTreeInAnyOrderIsTheSameTree) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    expect_square_tree(read_text(SquareTree().shuffled(seed, false)), "MERGED_SQUARES");
  }
}

TEST(LooseSquares, NamedGroupsInAnyOrderAreTheSameTree) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Skeleton skeleton = read_text(SquareTree().shuffled(seed, true));
    expect_square_tree(skeleton, "SQUARES_PER_GROUP");
    EXPECT_EQ(skeleton.branches[0].name, "trunk1");
  }
}

TEST(LooseSquares, AnOrderThatMeansSomethingIsKept) {
  const SquareTree tree;
  std::string text = tree.vertices.str();
  for (size_t i = 0; i < tree.faces.size(); ++i) text += tree.names[i] + tree.faces[i];
  const Skeleton skeleton = read_text(text);
  EXPECT_THAT(skeleton.report.warnings, IsEmpty());
  EXPECT_THAT(skeleton.report.branches_per_level, ElementsAre(1, 4));
}

}  // namespace
}  // namespace snowbough::tree
