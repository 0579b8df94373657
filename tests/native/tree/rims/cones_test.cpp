#include "tree/rims/cones.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <random>
#include <utility>

#include "native/tree/rims/built_tubes.h"

namespace snowbough::tree {
namespace {

/// A limb that winds as a screw, one metre a turn of twenty sections, thick and thin in turn.
std::vector<TubeSection> screw(int count) {
  std::vector<TubeSection> sections;
  for (int i = 0; i < count; ++i) {
    const double turn = 0.1 * M_PI * i;
    TubeSection& section = sections.emplace_back();
    section.centre = {std::cos(turn), std::sin(turn), 0.05 * i};
    section.radius = i % 2 == 0 ? 0.1 : 0.02;
  }
  return sections;
}

std::shared_ptr<const ConeChain> chain_of(const std::vector<TubeSection>& sections) {
  auto chain = std::make_shared<ConeChain>();
  chain->add(sections);
  chain->finish();
  return chain;
}

TEST(Cones, TheNearestOfALongRunIsThatOfAllOneByOne) {
  const std::vector<TubeSection> sections = screw(200);
  const auto chain = chain_of(sections);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> side(-2.0, 2.0), height(-1.0, 11.0);
  for (const auto& [begin, end] : {std::pair<size_t, size_t>{0, 199}, {3, 5}, {50, 131}}) {
    const ConeRun run{chain, begin, (begin + end) / 2, end};
    for (int i = 0; i < 200; ++i) {
      const glm::dvec3 p(side(random), side(random), height(random));
      FieldValue one_by_one{1e300, glm::dvec3(0.0)};
      for (size_t c = begin; c < end; ++c) {
        Cone::between(sections[c].centre, sections[c].radius, sections[c + 1].centre,
                      sections[c + 1].radius)
            .take_nearer(p, one_by_one);
      }
      EXPECT_EQ(run.distance_from(p).distance, one_by_one.distance);
    }
  }
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
