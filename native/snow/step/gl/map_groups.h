#pragma once

#include <cstdint>
#include <vector>

#include "gpu/resources.h"
#include "snow/scene/map_plan.h"

namespace snowbough::snow {

/// Maps of one size in one texture array. Objects with neighbouring slots share it.
struct MapGroup {
  int32_t resolution = 0;
  /// Slots of its objects: [first_slot, end_slot); layer = slot - first_slot.
  int32_t first_slot = 0;
  int32_t end_slot = 0;
  /// Snow thickness in metres, R32F.
  gpu::Texture height;
  /// Only for the deposit's mapping GEOMETRY: who owns a texel, RG32UI: x = 1 + index in the group
  /// (0 = none), y = chart << 8 | coverage; a step's deposit in metres, R32F, and its target.
  gpu::Texture owners;
  gpu::Texture deposit;
  gpu::Framebuffer deposit_target;

  int32_t layers() const { return end_slot - first_slot; }
  int64_t layer_bytes() const { return int64_t{4} * resolution * resolution; }
  /// Copies one layer's heights out or in. GPU thread.
  void read_height(int32_t layer, std::vector<float>& heights) const;
  void write_height(int32_t layer, const std::vector<float>& heights);
};

/// Allocates a group's maps, empty. GPU thread.
MapGroup make_map_group(const MapPlan::Group& plan, bool with_owners);

}  // namespace snowbough::snow
