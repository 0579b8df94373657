#include "snow/output/map_memory.h"

#include <algorithm>
#include <utility>

namespace snowbough::snow {

std::vector<float> MapMemory::acquire(size_t count) {
  {
    const std::scoped_lock lock(mutex_);
    const auto found = std::find_if(kept_.begin(), kept_.end(),
                                    [count](const auto& map) { return map.size() == count; });
    if (found != kept_.end()) {
      std::vector<float> map = std::move(*found);
      kept_.erase(found);
      return map;
    }
  }
  return std::vector<float>(count);
}

void MapMemory::release(std::vector<float>&& map) {
  std::vector<float> oldest;  // released behind the lock
  const std::scoped_lock lock(mutex_);
  if (kept_.size() == kMaxKept) {
    oldest = std::move(kept_.front());
    kept_.erase(kept_.begin());
  }
  kept_.push_back(std::move(map));
}

}  // namespace snowbough::snow
