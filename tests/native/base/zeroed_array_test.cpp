#include "base/zeroed_array.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

namespace snowbough::base {
namespace {

TEST(ZeroedArray, HoldsZeroesUntilWritten) {
  const ZeroedArray<float> values(100000);
  EXPECT_EQ(values.size(), 100000u);
  EXPECT_TRUE(std::all_of(values.data(), values.data() + values.size(),
                          [](float value) { return value == 0.0f; }));
  values.data()[99999] = 2.0f;
  EXPECT_EQ(values.data()[99999], 2.0f);
}

TEST(ZeroedArray, IsMovedWithoutACopy) {
  ZeroedArray<int> one(3);
  ZeroedArray<int> other(5);
  const int* const data = one.data();
  std::swap(one, other);
  EXPECT_EQ(other.data(), data);
  EXPECT_EQ(other.size(), 3u);
  EXPECT_EQ(one.size(), 5u);
}

}  // namespace
}  // namespace snowbough::base
