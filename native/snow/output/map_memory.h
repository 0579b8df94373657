#pragma once

#include <cstddef>
#include <mutex>
#include <vector>

namespace snowbough::snow {

/// Pool of the memory of finished maps, for reuse: allocating many megabytes and touching them for
/// the first time costs more than a pass over a map. Thread-safe.
class MapMemory {
 public:
  /// `count` heights of undefined value.
  std::vector<float> acquire(size_t count);
  /// Keeps a map's memory; beyond kMaxKept maps the oldest is freed.
  void release(std::vector<float>&& map);

 private:
  /// Number of maps in flight: one read back, two in work, one being written.
  static constexpr size_t kMaxKept = 4;

  std::mutex mutex_;
  std::vector<std::vector<float>> kept_;
};

}  // namespace snowbough::snow
