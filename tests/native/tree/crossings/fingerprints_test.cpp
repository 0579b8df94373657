#include "tree/crossings/fingerprints.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "native/tree/built_surface.h"
#include "tree/crossings/crossings.h"
#include "tree/crossings/neighbourhoods.h"

namespace snowbough::tree {
namespace {

using testing::Contains;
using testing::Each;
using testing::IsEmpty;
using testing::Not;

Surface two_branches() {
  return build(make_skeleton({trunk(), side_branch(2.5f, 0.05f), side_branch(2.6f, 0.05f)}))
      .surface;
}

std::vector<int32_t> first_faces(int count) {
  std::vector<int32_t> faces(count);
  std::iota(faces.begin(), faces.end(), 0);
  return faces;
}

TEST(Fingerprints, AreThoseOfTheSameFacesWhateverWasLookedAtBefore) {
  const Surface surface = two_branches();
  Fingerprints prints(surface);
  const uint64_t print = prints.of(first_faces(10));
  EXPECT_NE(prints.of(first_faces(11)), print);
  EXPECT_EQ(prints.of(first_faces(10)), print);
  EXPECT_EQ(Fingerprints(surface).of(first_faces(10)), print);
}

TEST(Fingerprints, DoNotDependOnHowVerticesAreNumbered) {
  const Surface surface = two_branches();
  Surface renumbered = surface;
  const auto last = static_cast<int32_t>(surface.vertices.size()) - 1;
  std::reverse(renumbered.vertices.begin(), renumbered.vertices.end());
  for (Quad& quad : renumbered.quads) {
    for (int32_t& v : quad) v = last - v;
  }
  EXPECT_EQ(Fingerprints(surface).of(first_faces(10)),
            Fingerprints(renumbered).of(first_faces(10)));
}

TEST(Fingerprints, ChangeWithAPlaceAndWithWhatIsShared) {
  const Surface surface = two_branches();
  const uint64_t print = Fingerprints(surface).of(first_faces(10));
  Surface moved = surface;
  moved.vertices[moved.quads[9][2]].x += 1e-5;
  EXPECT_NE(Fingerprints(moved).of(first_faces(10)), print);
  Surface torn = surface;
  torn.vertices.push_back(torn.vertices[torn.quads[9][0]]);
  torn.quads[9][0] = static_cast<int32_t>(torn.vertices.size()) - 1;
  EXPECT_NE(Fingerprints(torn).of(first_faces(10)), print);
}

TEST(CrossingMemo, WhatLooksTheSameIsTakenOverAndWhatMovedIsSearched) {
  Surface surface = two_branches();
  ASSERT_EQ(surface.junctions.size(), 2u);
  CrossingMemo memo(surface.limbs.size());
  const JunctionCrossings none = find_crossings(surface, {}, {}, &memo);
  ASSERT_THAT(none, Each(IsEmpty()));
  EXPECT_EQ(find_crossings(surface, {}, {}, &memo), none);

  // A branch's first ring is pushed through the trunk.
  for (const int32_t v : surface.limbs[1].rings[1].vertices) surface.vertices[v].x -= 2.0;
  const JunctionCrossings crossings = find_crossings(surface, {}, {}, &memo);
  EXPECT_EQ(crossings, find_crossings(surface));
  EXPECT_THAT(crossings, Contains(Not(IsEmpty())));
  EXPECT_EQ(find_crossings(surface, {}, {}, &memo), crossings);
}

TEST(CrossingMemo, IsAskedBeforeASearch) {
  const Surface surface = two_branches();
  CrossingMemo memo(surface.limbs.size());
  find_crossings(surface, {}, {}, &memo);
  const VertexFaces around(surface);
  Neighbourhoods neighbourhoods(surface, around);
  const std::vector<int32_t> faces = neighbourhoods.at(surface.junctions[0]);
  const int32_t child = surface.junctions[0].child;
  const uint64_t print = Fingerprints(surface).of(faces);
  ASSERT_NE(memo.known(child, print), nullptr);
  EXPECT_EQ(memo.known(child, print + 1), nullptr);
  EXPECT_EQ(memo.hits(), 1);
  memo.set(child, print, {{1, 0}});
  const JunctionCrossings crossings = find_crossings(surface, {}, {}, &memo);
  EXPECT_EQ(crossings[0],
            (std::vector{std::pair(std::min(faces[0], faces[1]), std::max(faces[0], faces[1]))}));
  EXPECT_TRUE(crossings[1].empty());
}

}  // namespace
}  // namespace snowbough::tree
