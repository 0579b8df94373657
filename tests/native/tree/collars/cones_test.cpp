#include "tree/collars/cones.h"

#include <gtest/gtest.h>

#include <memory>
#include <utility>

#include "native/tree/collars/built_tubes.h"

namespace snowbough::tree {
namespace {

std::shared_ptr<const ConeChain> chain_of(const std::vector<TubeSection>& sections) {
  auto chain = std::make_shared<ConeChain>();
  chain->add(sections);
  return chain;
}

TEST(Cones, ARunReachesAsFarAsItsLengthBothWays) {
  std::vector<TubeSection> straight(11);
  for (size_t i = 0; i < straight.size(); ++i) {
    straight[i].centre = {0.0, 0.0, static_cast<double>(i)};
  }
  const auto chain = chain_of(straight);
  const auto reach = [&](size_t at, double length) {
    const ConeRun run = ConeRun::around(chain, at, length);
    return std::pair(run.begin, run.end);
  };
  EXPECT_EQ(reach(5, 0.5), std::pair(size_t{4}, size_t{6}));
  EXPECT_EQ(reach(5, 2.5), std::pair(size_t{2}, size_t{8}));
  EXPECT_EQ(reach(0, 2.5), std::pair(size_t{0}, size_t{3}));
  EXPECT_EQ(reach(10, 2.5), std::pair(size_t{7}, size_t{10}));
  EXPECT_EQ(reach(5, 100.0), std::pair(size_t{0}, size_t{10}));
}

TEST(Cones, AllForksOfALimbHaveItsConesInCommon) {
  const BuiltTubes built(
      make_skeleton({trunk(0.2f), side_branch(2.5f, 0.05f), side_branch(5.5f, 0.05f)}));
  ASSERT_EQ(built.forks.size(), 2u);
  EXPECT_EQ(built.forks[0].parent.chain, built.forks[1].parent.chain);
}

}  // namespace
}  // namespace snowbough::tree
