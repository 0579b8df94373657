#include "tree/collars/cones.h"

#include <gtest/gtest.h>

#include <memory>
#include <random>
#include <span>
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

TEST(Cones, TheNearestOfARunIsTheNearestOfAllItsCones) {
  std::mt19937 random(41);
  std::uniform_real_distribution<double> step(-1.0, 1.0);
  std::vector<TubeSection> bent(61);
  for (size_t i = 1; i < bent.size(); ++i) {
    bent[i].centre = bent[i - 1].centre + glm::dvec3(step(random), step(random), 0.4);
    bent[i].radius = 0.6 + 0.5 * step(random);
  }
  auto chain = std::make_shared<ConeChain>();
  chain->add(std::span(bent).first(24));
  chain->add(std::span(bent).subspan(23));
  const ConeRun run = ConeRun::around(chain, 30, 25.0);
  for (int i = 0; i < 2000; ++i) {
    const glm::dvec3 p(5.0 * step(random), 5.0 * step(random), 12.0 + 12.0 * step(random));
    FieldValue nearest{1e300, glm::dvec3(0.0)};
    const auto take = [&](size_t k) {
      const TubeSection &a = bent[k], &b = bent[k + 1];
      Cone::between(a.centre, a.radius, b.centre, b.radius).take_nearer(p, nearest);
    };
    for (size_t k = run.at; k < run.end; ++k) take(k);
    for (size_t k = run.at; k-- > run.begin;) take(k);
    const FieldValue found = run.distance_from(p, 1e300);
    ASSERT_EQ(found.distance, nearest.distance);
    ASSERT_EQ(found.gradient, nearest.gradient);
  }
}

TEST(Cones, AllForksOfALimbHaveItsConesInCommon) {
  const BuiltTubes built(
      make_skeleton({trunk(0.2f), side_branch(2.5f, 0.05f), side_branch(5.5f, 0.05f)}));
  ASSERT_EQ(built.forks.size(), 2u);
  EXPECT_EQ(built.forks[0].parent.chain, built.forks[1].parent.chain);
}

}  // namespace
}  // namespace snowbough::tree
