#include "tree/skeleton/attach.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <limits>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "tree/read/levels.h"
#include "tree/read/part_names.h"
#include "tree/read_tree.h"

namespace snowbough::tree {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

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

TEST(Attach, HoweverLimbsLieNoCycleArises) {
  // Equal limbs that all start, end and cross in the same few places, with and without levels.
  for (uint32_t seed = 0; seed < 50; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    const auto place = [&] { return glm::vec3(random() % 3, random() % 3, random() % 3); };
    std::vector<Branch> branches;
    for (int i = 0; i < 40; ++i) {
      branches.push_back(tapering("limb" + std::to_string(i), {place(), place(), place()},
                                  0.1f * static_cast<float>(1 + random() % 2)));
      branches.back().level = seed % 2 == 0 ? -1 : static_cast<int32_t>(random() % 3);
    }
    std::vector<char> reversible(branches.size(), 1);
    attach_branches(branches, reversible, 3.0f);
    for (size_t b = 0; b < branches.size(); ++b) {
      EXPECT_LT(branches[b].parent, static_cast<int32_t>(b));
    }
  }
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
