#pragma once

#include <cstddef>
#include <mutex>
#include <vector>

namespace snowbough::snow {

/// Memory of maps that are done with, kept for the next ones: to be given many megabytes by the
/// system and to fill them for the first time costs more than a whole pass over a map. For any
/// thread.
class MapMemory {
 public:
  /// `count` heights of any value.
  std::vector<float> take(size_t count);
  /// Keeps a map's memory; beyond kMostKept maps the oldest goes.
  void give(std::vector<float>&& map);

 private:
  /// As many as are under way at a time: one read back, two made, one written.
  static constexpr size_t kMostKept = 4;

  std::mutex mutex_;
  std::vector<std::vector<float>> kept_;
};

}  // namespace snowbough::snow
