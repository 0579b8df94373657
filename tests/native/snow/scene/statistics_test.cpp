#include "snow/scene/statistics.h"

#include <gtest/gtest.h>

namespace snowbough::snow {
namespace {

/// Volumes that floats hold exactly.
shared::ObjectSums sums() {
  shared::ObjectSums made{};
  made.held_before = 8.0f;
  made.deposited = 4.0f;
  made.slid = 1.0f;
  made.held = 11.5f;
  made.visible_area = 3.0f;
  made.back_face_area = 1.0f;
  made.total_deposited = 64.0f;
  made.total_slid = 32.0f;
  made.total_stretched = 0.25f;
  made.total_visible_area = 48.0f;
  return made;
}

TEST(Balance, BooksTheRemainderAsStretched) {
  EXPECT_EQ(balance_of(sums()).step.stretched_volume, 0.5);
}

TEST(Balance, HeldIsTheCurrentVolumeInBoth) {
  const StatisticsPair pair = balance_of(sums());
  EXPECT_EQ(pair.step.held_volume, 11.5);
  EXPECT_EQ(pair.total.held_volume, 11.5);
  EXPECT_EQ(pair.total.deposited_volume, 64.0);
  EXPECT_EQ(pair.total.slid_volume, 32.0);
  EXPECT_EQ(pair.total.stretched_volume, 0.25);
  EXPECT_EQ(pair.total.visible_area, 48.0);
}

TEST(Balance, TellsTheShareOfBackFacesInWhatTheSkySees) {
  EXPECT_EQ(balance_of(sums()).step.back_face_share(), 0.25);
  EXPECT_EQ(SnowBalance{}.back_face_share(), 0.0);
}

TEST(Balance, OfTwoObjectsIsTheirSum) {
  StatisticsPair all = balance_of(sums());
  add_balance(all, balance_of(sums()));
  EXPECT_EQ(all.step.deposited_volume, 8.0);
  EXPECT_EQ(all.step.back_face_area, 2.0);
  EXPECT_EQ(all.total.stretched_volume, 0.5);
}

}  // namespace
}  // namespace snowbough::snow
