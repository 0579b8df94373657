#include "tree/rings/square_rows.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "native/tree/rings/sections.h"

namespace snowbough::tree {
namespace {

using ::testing::ElementsAre;
using ::testing::UnorderedElementsAre;

/// From the side 1 of a plane to the side 0 of another, along a pole.
Link up(uint32_t from, uint32_t to, double length = 1.0) {
  return {length, from, to, 1, 0, length};
}

TEST(Rows, BeginAsOnePlaneEach) {
  EXPECT_THAT(Rows(3).rows(), ElementsAre(ElementsAre(0u), ElementsAre(1u), ElementsAre(2u)));
}

TEST(Rows, GrowTogetherLinkByLinkInAnyOrder) {
  Rows rows(4);
  rows.link(up(2, 3));
  rows.link(up(0, 1));
  rows.link(up(1, 2));
  EXPECT_THAT(rows.rows(), ElementsAre(ElementsAre(0u, 1u, 2u, 3u)));
}

TEST(Rows, KeepTheFirstLinkOfASide) {
  Rows rows(3);
  rows.link(up(0, 1));
  rows.link(up(0, 2));
  EXPECT_THAT(rows.rows(), UnorderedElementsAre(ElementsAre(0u, 1u), ElementsAre(2u)));
}

TEST(Rows, DoNotCloseToLoops) {
  Rows rows(3);
  rows.link(up(0, 1));
  rows.link(up(1, 2));
  rows.link(up(2, 0));
  EXPECT_THAT(rows.rows(), ElementsAre(ElementsAre(0u, 1u, 2u)));
}

TEST(Rows, TakeNoLinkSixTimesAsLongAsThePlanesOther) {
  Rows rows(4);
  rows.link(up(0, 1, 1.0));
  rows.link(up(1, 2, 6.5));
  EXPECT_THAT(rows.rows(),
              UnorderedElementsAre(ElementsAre(0u, 1u), ElementsAre(2u), ElementsAre(3u)));
  rows.link(up(1, 3, 5.5));
  EXPECT_THAT(rows.rows(), UnorderedElementsAre(ElementsAre(0u, 1u, 3u), ElementsAre(2u)));
}

TEST(Rows, AreCutWhereALinkIsFarLongerThanBothBesideIt) {
  Rows rows(4);
  rows.link(up(0, 1, 1.0));
  rows.link(up(1, 2, 3.0));
  rows.link(up(2, 3, 1.0));
  rows.cut_jumps();
  EXPECT_THAT(rows.rows(), UnorderedElementsAre(ElementsAre(0u, 1u), ElementsAre(2u, 3u)));
}

TEST(Rows, StayWholeWhereDistancesGrowSteadilyOrTheLongOneIsTheLast) {
  Rows rows(4);
  rows.link(up(0, 1, 1.0));
  rows.link(up(1, 2, 2.0));
  rows.link(up(2, 3, 5.5));
  rows.cut_jumps();
  EXPECT_THAT(rows.rows(), ElementsAre(ElementsAre(0u, 1u, 2u, 3u)));
}

/// A pole of five squares, 0 to 4; a twig leaves it: its root 5 stands beside the line from 2 on,
/// and 6 and 7 continue from 5.
struct PoleAndTwig {
  std::vector<Plane> planes;

  PoleAndTwig() {
    std::vector<CrossSection> sections = pole(5);
    const glm::vec3 along = glm::normalize(glm::vec3(1, 0, 0.5f));
    for (int i = 0; i < 3; ++i) {
      sections.push_back(
          square_across(glm::vec3(0.2f, 0, 2.7f) + 0.8f * i * along, along, 0.2f - 0.04f * i));
    }
    planes = planes_of(sections);
  }

  Link link(uint32_t from, uint32_t to) const {
    const glm::dvec3 step = planes[to].centre - planes[from].centre;
    const double length = glm::length(step);
    return {length,
            from,
            to,
            static_cast<uint8_t>(planes[from].side(step)),
            static_cast<uint8_t>(planes[to].side(-step)),
            length};
  }
};

TEST(Rows, ChangeOverFromATwigsRootToTheirOwnLimbThatWaitsBehindIt) {
  const PoleAndTwig scene;
  Rows rows(scene.planes.size());
  // Earlier, the pole continued with the twig's root, which is nearer than its next square.
  for (const auto& [from, to] : {std::pair{0, 1}, {1, 2}, {2, 5}, {5, 6}, {6, 7}, {3, 4}}) {
    rows.link(scene.link(static_cast<uint32_t>(from), static_cast<uint32_t>(to)));
  }
  ASSERT_THAT(rows.rows(),
              UnorderedElementsAre(ElementsAre(0u, 1u, 2u, 5u, 6u, 7u), ElementsAre(3u, 4u)));
  const Links links(scene.planes);
  EXPECT_TRUE(rows.relink(links, scene.planes));
  EXPECT_THAT(rows.rows(),
              UnorderedElementsAre(ElementsAre(0u, 1u, 2u, 3u, 4u), ElementsAre(5u, 6u, 7u)));
  EXPECT_FALSE(rows.relink(links, scene.planes));
}

}  // namespace
}  // namespace snowbough::tree
