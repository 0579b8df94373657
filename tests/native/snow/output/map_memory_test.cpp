#include "snow/output/map_memory.h"

#include <gtest/gtest.h>

namespace snowbough::snow {
namespace {

TEST(MapMemory, HandsOutWhatWasGivenBack) {
  MapMemory memory;
  std::vector<float> map = memory.acquire(100);
  EXPECT_EQ(map.size(), 100u);
  const float* const place = map.data();
  memory.release(std::move(map));
  EXPECT_NE(memory.acquire(50).data(), place);
  const std::vector<float> again = memory.acquire(100);
  EXPECT_EQ(again.data(), place);
  // The memory is in use again, so the next map gets other memory.
  EXPECT_NE(memory.acquire(100).data(), place);
}

TEST(MapMemory, KeepsTheLastFourOnly) {
  MapMemory memory;
  std::vector<const float*> places;
  std::vector<std::vector<float>> maps;
  for (int i = 0; i < 5; ++i) {
    maps.push_back(memory.acquire(100));
    places.push_back(maps.back().data());
  }
  for (std::vector<float>& map : maps) memory.release(std::move(map));
  std::vector<std::vector<float>> again;
  for (int i = 1; i < 5; ++i) {
    again.push_back(memory.acquire(100));
    EXPECT_EQ(again.back().data(), places[static_cast<size_t>(i)]);
  }
}

}  // namespace
}  // namespace snowbough::snow
