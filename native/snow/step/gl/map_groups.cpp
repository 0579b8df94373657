#include "snow/step/gl/map_groups.h"

namespace snowbough::snow {

void MapGroup::read_height(int32_t layer, std::vector<float>& heights) const {
  heights.resize(static_cast<size_t>(layer_bytes()) / sizeof(float));
  height.read(layer, GL_RED, GL_FLOAT, layer_bytes(), heights.data());
}

void MapGroup::write_height(int32_t layer, const std::vector<float>& heights) {
  height.write(layer, GL_RED, GL_FLOAT, heights.data());
}

MapGroup make_map_group(const MapPlan::Group& plan, bool with_owners) {
  MapGroup group;
  group.resolution = plan.resolution;
  group.first_slot = plan.first_slot;
  group.end_slot = plan.end_slot;
  group.height = gpu::Texture(GL_R32F, plan.resolution, plan.resolution, group.layers());
  if (with_owners) {
    group.owners = gpu::Texture(GL_RG32UI, plan.resolution, plan.resolution, group.layers());
  }
  return group;
}

}  // namespace snowbough::snow
