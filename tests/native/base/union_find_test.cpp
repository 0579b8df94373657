#include "base/union_find.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>

namespace snowbough::base {
namespace {

using testing::ElementsAre;

TEST(UnionFind, TheSmallestOfASetStandsForItInWhateverOrderTheyJoin) {
  UnionFind sets(6);
  EXPECT_EQ(sets.join(5, 4), 4);
  EXPECT_EQ(sets.join(2, 3), 2);
  EXPECT_EQ(sets.join(5, 3), 2);
  EXPECT_EQ(sets.find(4), 2);
  EXPECT_EQ(sets.find(1), 1);
  EXPECT_THAT(std::move(sets).all(), ElementsAre(0, 1, 2, 2, 2, 2));
}

TEST(UnionFind, JoiningASetWithItselfChangesNothing) {
  UnionFind sets(3);
  sets.join(1, 2);
  EXPECT_EQ(sets.join(2, 1), 1);
  EXPECT_THAT(std::move(sets).all(), ElementsAre(0, 1, 1));
}

}  // namespace
}  // namespace snowbough::base
