#pragma once

#include <cstddef>
#include <vector>

namespace snowbough::snow {

/// A receiver's map while the passes that move lying snow run.
struct MovingMap {
  /// Index of its object, sorted by name.
  size_t object = 0;
  /// Thickness in metres, row by row, negative on the back.
  std::vector<float>* height = nullptr;
  /// Out: volume that left the map, in m3.
  double slid = 0.0;
  /// Out: whether heights changed.
  bool has_changed = false;
};

}  // namespace snowbough::snow
