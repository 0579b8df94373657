#include "tree/read/part_names.h"

#include <gtest/gtest.h>

namespace snowbough::tree {
namespace {

TEST(PartNames, TheLastWordCounts) {
  EXPECT_EQ(meaning_of_name("Dogwood_Leaf.001"), NameMeaning::kFoliage);
  EXPECT_EQ(meaning_of_name("leaf_stem"), NameMeaning::kWood);
  EXPECT_EQ(meaning_of_name("AL06lef1"), NameMeaning::kFoliage);
  EXPECT_EQ(meaning_of_name("left_side"), NameMeaning::kSilent);
  EXPECT_EQ(meaning_of_name("default"), NameMeaning::kSilent);
}

}  // namespace
}  // namespace snowbough::tree
