#include "snow/scene/map_plan.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

namespace snowbough::snow {
namespace {

TEST(MapPlan, GroupsMapsBySizeAndSplitsLargeArrays) {
  std::vector<SceneObject> objects;
  for (int i = 0; i < 5; ++i) {
    SceneObject object;
    object.description.name = std::string(1, static_cast<char>('a' + i));
    object.description.topology.resolution = i == 2 ? 64 : 16384;
    object.description.receive = i != 4;
    objects.push_back(std::move(object));
  }
  std::vector<const SceneObject*> pointers;
  for (const SceneObject& object : objects) {
    pointers.push_back(&object);
  }
  const MapPlan plan = plan_maps(pointers, 2048);
  EXPECT_EQ(plan.slot, (std::vector<int32_t>{1, 2, 0, 3, 4}));
  // A map takes 1 GiB: one an array.
  ASSERT_EQ(plan.groups.size(), 4u);
  EXPECT_EQ(plan.group, (std::vector<int32_t>{1, 2, 0, 3, -1}));
}

}  // namespace
}  // namespace snowbough::snow
