#include "snow/scene/map_plan.h"

#include <algorithm>
#include <numeric>

namespace snowbough::snow {

MapPlan plan_maps(const std::vector<const SceneObject*>& objects, int32_t max_layers) {
  constexpr int64_t kBytesPerTexel = sizeof(float);
  MapPlan plan;
  plan.slot.resize(objects.size());
  plan.group.assign(objects.size(), -1);
  std::vector<int32_t> order(objects.size());
  std::iota(order.begin(), order.end(), 0);
  const auto size_of = [&](int32_t i) {
    const ObjectDescription& object = objects[static_cast<size_t>(i)]->description;
    return object.receive ? object.topology.resolution : 1 << 30;
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](int32_t a, int32_t b) { return size_of(a) < size_of(b); });
  for (size_t slot = 0; slot < order.size(); ++slot) {
    const auto object = static_cast<size_t>(order[slot]);
    plan.slot[object] = static_cast<int32_t>(slot);
    if (!objects[object]->description.receive) {
      continue;
    }
    const int32_t resolution = objects[object]->description.topology.resolution;
    const int64_t room = std::clamp<int64_t>(
        kLargestArrayBytes / (kBytesPerTexel * resolution * resolution), 1, max_layers);
    if (plan.groups.empty() || plan.groups.back().resolution != resolution ||
        plan.groups.back().end_slot - plan.groups.back().first_slot >= room) {
      plan.groups.push_back({resolution, static_cast<int32_t>(slot), static_cast<int32_t>(slot)});
    }
    plan.groups.back().end_slot = static_cast<int32_t>(slot) + 1;
    plan.group[object] = static_cast<int32_t>(plan.groups.size()) - 1;
  }
  return plan;
}

}  // namespace snowbough::snow
