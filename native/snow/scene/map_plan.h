#pragma once

#include <cstdint>
#include <vector>

#include "snow/scene/scene_object.h"

namespace snowbough::snow {

/// Largest texture array in bytes; maps of one size that need more use several arrays.
inline constexpr int64_t kLargestArrayBytes = int64_t{1} << 30;

/// Assigns maps to texture arrays: receivers sorted by size, then name, get slots 0, 1, ...; other
/// objects follow. Needs no GPU, so that memory can be estimated beforehand.
struct MapPlan {
  struct Group {
    int32_t resolution = 0;
    int32_t first_slot = 0;
    int32_t end_slot = 0;
  };
  std::vector<Group> groups;
  /// Per object (in the order given): its slot, and its group (-1 for objects that do not receive).
  std::vector<int32_t> slot;
  std::vector<int32_t> group;
};

/// `objects` are sorted by name. `max_layers` is the driver's limit.
MapPlan plan_maps(const std::vector<const SceneObject*>& objects, int32_t max_layers);

}  // namespace snowbough::snow
