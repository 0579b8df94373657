#include "snow/map_store.h"

#include <algorithm>
#include <numeric>

namespace snowbough::snow {

MapPlan plan_maps(const std::vector<const SceneObject*>& objects, int32_t max_layers) {
  // The owner table is the widest array: 8 bytes a texel.
  constexpr int64_t kBytesPerTexel = 8;
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

void MapGroup::read_height(int32_t layer, std::vector<float>& heights) const {
  heights.resize(static_cast<size_t>(layer_bytes()) / sizeof(float));
  if (height_rows.id() != 0) {
    height_rows.read(layer_bytes() * layer, layer_bytes(), heights.data());
  } else {
    height.read(layer, GL_RED, GL_FLOAT, layer_bytes(), heights.data());
  }
}

void MapGroup::write_height(int32_t layer, const std::vector<float>& heights) {
  if (height_rows.id() != 0) {
    height_rows.write(layer_bytes() * layer, layer_bytes(), heights.data());
  } else {
    height.write(layer, GL_RED, GL_FLOAT, heights.data());
  }
}

MapGroup make_map_group(const MapPlan::Group& plan, bool on_processor, bool with_owners) {
  MapGroup group;
  group.resolution = plan.resolution;
  group.first_slot = plan.first_slot;
  group.end_slot = plan.end_slot;
  if (on_processor) {
    group.height_rows = gpu::Buffer(group.layer_bytes() * group.layers());
  } else {
    group.height = gpu::Texture(GL_R32F, plan.resolution, plan.resolution, group.layers());
  }
  if (with_owners) {
    group.owners = gpu::Texture(GL_RG32UI, plan.resolution, plan.resolution, group.layers());
  }
  return group;
}

}  // namespace snowbough::snow
