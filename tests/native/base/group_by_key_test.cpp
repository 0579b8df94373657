#include "base/group_by_key.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace snowbough::base {
namespace {

TEST(GroupByKey, GroupsKeepTheOrderOfTheirValuesAndMayBeEmpty) {
  const std::vector<std::pair<int, char>> all = {{2, 'a'}, {0, 'b'}, {2, 'c'}, {3, 'd'}, {0, 'e'}};
  std::vector<int> begin;
  std::vector<char> values;
  group_by_key(
      4,
      [&](const auto& visit) {
        for (const auto& [key, value] : all) visit(key, value);
      },
      begin, values);
  EXPECT_THAT(begin, testing::ElementsAre(0, 2, 2, 4, 5));
  EXPECT_THAT(values, testing::ElementsAre('b', 'e', 'a', 'c', 'd'));
}

}  // namespace
}  // namespace snowbough::base
