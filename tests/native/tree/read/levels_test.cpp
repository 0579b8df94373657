#include "tree/read/levels.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace snowbough::tree {
namespace {

using testing::ElementsAre;

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

}  // namespace
}  // namespace snowbough::tree
