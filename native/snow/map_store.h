#pragma once

#include <cstdint>
#include <vector>

#include "gpu/resources.h"
#include "snow/scene_object.h"

namespace snowbough::snow {

/// Largest texture array in bytes; maps of one size that need more are spread over several.
inline constexpr int64_t kLargestArrayBytes = int64_t{1} << 30;

/// Maps of one size in one texture array. Objects with neighbouring slots share it.
struct MapGroup {
  int32_t resolution = 0;
  /// Slots of its objects: [first_slot, end_slot); layer = slot - first_slot.
  int32_t first_slot = 0;
  int32_t end_slot = 0;
  /// Snow thickness in metres, R32F; where kernels run on the processor, the same in a buffer,
  /// layer by layer and row by row.
  gpu::Texture height;
  gpu::Buffer height_rows;
  /// Only for the deposit's mapping GEOMETRY: who owns a texel, RG32UI: x = 1 + index in the group
  /// (0 = nobody), y = chart << 8 | coverage; a step's deposit in metres, R32F, and its target.
  gpu::Texture owners;
  gpu::Texture deposit;
  gpu::Framebuffer deposit_target;

  int32_t layers() const { return end_slot - first_slot; }
  int64_t layer_bytes() const { return int64_t{4} * resolution * resolution; }
  /// Copies one layer's heights out or in. GPU thread.
  void read_height(int32_t layer, std::vector<float>& heights) const;
  void write_height(int32_t layer, const std::vector<float>& heights);
};

/// The plan of which map lies where: receivers sorted by size, then name, get slots 0, 1, ...; what
/// does not receive follows. It needs no GPU, so that memory can be told beforehand.
struct MapPlan {
  struct Group {
    int32_t resolution = 0;
    int32_t first_slot = 0;
    int32_t end_slot = 0;
  };
  std::vector<Group> groups;
  /// Per object (in the order given): its slot, and its group (-1 for what does not receive).
  std::vector<int32_t> slot;
  std::vector<int32_t> group;
};

/// `objects` are sorted by name. `max_layers` is the driver's limit.
MapPlan plan_maps(const std::vector<const SceneObject*>& objects, int32_t max_layers);

/// Allocates a group's maps, empty. GPU thread.
MapGroup make_map_group(const MapPlan::Group& plan, bool on_processor, bool with_owners);

}  // namespace snowbough::snow
