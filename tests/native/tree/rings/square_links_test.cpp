#include "tree/rings/square_links.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "native/tree/rings/sections.h"

namespace snowbough::tree {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

/// A plane that looks along z.
Plane plane_at(const glm::dvec3& centre, double radius = 0.2) {
  return {centre, {0, 0, 1}, radius};
}

const Link* link_between(const std::vector<Link>& links, uint32_t from, uint32_t to) {
  const auto found = std::find_if(links.begin(), links.end(), [&](const Link& link) {
    return link.from == from && link.to == to;
  });
  return found == links.end() ? nullptr : &*found;
}

TEST(Planes, AreCentreUnitNormalAndRadiusOfSquares) {
  const std::vector<Plane> planes = planes_of(pole(3));
  ASSERT_THAT(planes, SizeIs(3));
  for (size_t i = 0; i < planes.size(); ++i) {
    EXPECT_NEAR(glm::distance(planes[i].centre, glm::dvec3(0, 0, i)), 0.0, 1e-6);
    EXPECT_NEAR(std::abs(planes[i].normal.z), 1.0, 1e-6);
    EXPECT_NEAR(planes[i].radius, 0.5 - 0.05 * static_cast<double>(i), 1e-6);
  }
}

TEST(Planes, WithoutAreaHaveNoNormalAndAreMetSquarelyFromAnywhere) {
  const glm::vec3 tip(0, 0, 2);
  const std::vector<CrossSection> sections = {pole(1)[0], {{tip, tip, tip, tip}}};
  const Plane plane = planes_of(sections)[1];
  EXPECT_FALSE(plane.has_normal());
  EXPECT_EQ(plane.across({1, 0, 0}), 1.0);
  EXPECT_EQ(plane.side({0, 0, 1}), 0);
  EXPECT_EQ(plane.side({0, 0, -1}), 0);
}

TEST(Links, OfAPlaneLeaveBySideAndTheNearestIsTheCheapest) {
  const std::vector<Plane> planes = planes_of(pole(5));
  const Links links(planes);
  const int up = planes[2].side({0, 0, 1});
  ASSERT_THAT(links.of(2, up), SizeIs(2));
  EXPECT_EQ(links.of(2, up)[0].to, 3u);
  EXPECT_EQ(links.of(2, up)[1].to, 4u);
  ASSERT_THAT(links.of(2, 1 - up), SizeIs(2));
  EXPECT_EQ(links.of(2, 1 - up)[0].to, 1u);
  EXPECT_NEAR(links.of(2, up)[0].length, 1.0, 1e-6);
  EXPECT_THAT(links.of(4, up), IsEmpty());
}

TEST(Links, BetweenPlanesSideBySideAreNone) {
  // The limit is 60 degrees off a normal.
  const std::vector<Plane> beyond = {plane_at({0, 0, 0}), plane_at({1.8, 0, 1})};
  EXPECT_THAT(Links(beyond).sorted(), IsEmpty());
  const std::vector<Plane> within = {plane_at({0, 0, 0}), plane_at({1.7, 0, 1})};
  EXPECT_THAT(Links(within).sorted(), SizeIs(2));
}

TEST(Links, CostTheirLengthSquareOnAndMoreAslantOrWhereTheRadiusJumps) {
  const std::vector<Plane> planes = {plane_at({0, 0, 0}), plane_at({0, 0, 1}),
                                     plane_at({0.3, 0, -1}), plane_at({0, 0, 2}, 0.02)};
  const std::vector<Link> links = Links(planes).sorted();
  const Link* const straight = link_between(links, 0, 1);
  const Link* const aslant = link_between(links, 0, 2);
  const Link* const thinner = link_between(links, 1, 3);
  ASSERT_TRUE(straight != nullptr && aslant != nullptr && thinner != nullptr);
  EXPECT_DOUBLE_EQ(straight->cost, 1.0);
  EXPECT_GT(aslant->cost, 2.0 * aslant->length);
  EXPECT_GT(thinner->cost, 2.0 * thinner->length);
  EXPECT_TRUE(std::is_sorted(links.begin(), links.end(),
                             [](const Link& a, const Link& b) { return a.cost < b.cost; }));
}

TEST(Links, AreTheTwelveCheapestOfASideEvenAmongMany) {
  std::vector<Plane> planes;
  for (int i = 0; i < 40; ++i) planes.push_back(plane_at({0, 0, i}));
  const Links links(planes);
  const std::vector<Link>& up = links.of(0, planes[0].side({0, 0, 1}));
  ASSERT_THAT(up, SizeIs(12));
  for (size_t k = 0; k < up.size(); ++k) EXPECT_EQ(up[k].to, k + 1);
}

TEST(Links, PassThroughAPlaneThatStandsSquarelyOnTheWay) {
  const std::vector<Plane> pole_planes = planes_of(pole(3));
  const Links links(pole_planes);
  const std::vector<Link> all = links.sorted();
  EXPECT_TRUE(links.passes_through_another(*link_between(all, 0, 2)));
  EXPECT_FALSE(links.passes_through_another(*link_between(all, 0, 1)));
}

TEST(Links, PassByAPlaneThatIsMuchThinnerOrOffTheWay) {
  const std::vector<Plane> thin = {plane_at({0, 0, 0}), plane_at({0, 0, 1}, 0.05),
                                   plane_at({0, 0, 2})};
  const Links past_thin(thin);
  EXPECT_FALSE(past_thin.passes_through_another(*link_between(past_thin.sorted(), 0, 2)));
  const std::vector<Plane> off = {plane_at({0, 0, 0}), plane_at({0.5, 0, 1}), plane_at({0, 0, 2})};
  const Links past_off(off);
  EXPECT_FALSE(past_off.passes_through_another(*link_between(past_off.sorted(), 0, 2)));
}

}  // namespace
}  // namespace snowbough::tree
