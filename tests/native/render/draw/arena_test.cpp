#include "render/draw/arena.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

#include "gpu/gpu_thread.h"

namespace snowbough::render {
namespace {

TEST(Ranges, gapsAreJoinedAndFilledAgain) {
  Ranges ranges;
  EXPECT_EQ(ranges.add(3), 0);
  EXPECT_EQ(ranges.add(4), 3);
  EXPECT_EQ(ranges.add(5), 7);
  EXPECT_EQ(ranges.add(1), 12);
  ranges.remove(3, 4);
  ranges.remove(0, 3);
  EXPECT_EQ(ranges.place_for(7), 0);
  EXPECT_EQ(ranges.add(6), 0);
  EXPECT_EQ(ranges.add(2), 13);
  ranges.remove(7, 5);
  EXPECT_EQ(ranges.add(6), 6);
  EXPECT_EQ(ranges.end(), 15);
  ranges.remove(12, 1);
  ranges.remove(13, 2);
  EXPECT_EQ(ranges.end(), 12);
}

TEST(Arena, elementsStayWhenItGrowsUpToItsLimit) {
  gpu::GpuThread::shared("")->run([] {
    Arena arena(sizeof(int32_t), 40);
    EXPECT_EQ(arena.add(std::vector<int32_t>{1, 2, 3, 4}), 0);
    EXPECT_EQ(arena.add(std::vector<int32_t>{5, 6}), 4);
    EXPECT_TRUE(arena.has_room(4));
    EXPECT_FALSE(arena.has_room(5));
    EXPECT_THROW(arena.add(std::vector<int32_t>(5)), std::length_error);
    arena.remove(0, 4);
    EXPECT_EQ(arena.add(std::vector<int32_t>{7, 8}), 0);
    EXPECT_EQ(arena.buffer().read_all<int32_t>()[5], 6);
    EXPECT_EQ(arena.buffer().read_all<int32_t>()[1], 8);
  });
}

}  // namespace
}  // namespace snowbough::render
