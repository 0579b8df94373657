#include "tree/skeleton/attach.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <random>
#include <string>
#include <vector>

#include "native/tree/skeletons.h"

namespace snowbough::tree {
namespace {

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

TEST(Attach, ATwigThatStartsInsideTheLimbBelongsToItNotToASiblingThere) {
  std::vector<Branch> branches{tapering("trunk", {{0, 0, 0}, {0, 0, 10}}, 0.5f),
                               tapering("first", {{0.1f, 0, 5}, {2, 0, 6}}, 0.11f),
                               tapering("second", {{0.2f, 0, 5.06f}, {2, 1, 6}}, 0.1f)};
  std::vector<char> reversible(3, 0);
  attach_branches(branches, reversible, 10.0f);
  EXPECT_EQ(branches[2].name, "second");
  EXPECT_EQ(branches[2].parent, 0);
  EXPECT_LT(glm::distance(branches[2].attach_point, glm::vec3(0, 0, 5.06f)), 1e-6f);
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

}  // namespace
}  // namespace snowbough::tree
