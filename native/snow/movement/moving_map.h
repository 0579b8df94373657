#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace snowbough::snow {

/// A receiver's map while the passes that move lying snow run.
struct MovingMap {
  /// Index of its object, sorted by name.
  size_t object = 0;
  /// Thickness in metres, row by row, negative on the back.
  std::vector<float>* height = nullptr;
  /// What stability let slide in this step: row * resolution + column, and volume in m3. Only if
  /// the step records it.
  std::vector<std::pair<int32_t, float>> slid_from = {};
  /// What leaves and boughs have let go, likewise.
  std::vector<std::pair<int32_t, float>> shed_from = {};
  /// For a coarser map than the receiver's own (CoarseMap): by its texels, a place on that; else
  /// null.
  const std::vector<int32_t>* places = nullptr;
  /// Out: volume that left the map, and that landed on it, in m3.
  double slid = 0.0;
  double landed = 0.0;
  /// Out: volume that a mask has refused, that objects have pressed and cleared away, and that has
  /// melted, in m3; and that the wind has carried away, less what it has brought.
  double masked = 0.0;
  double pressed = 0.0;
  double cleared = 0.0;
  double melted = 0.0;
  double drifted = 0.0;
  /// Out: whether heights changed.
  bool has_changed = false;

  double removed() const { return masked + pressed + cleared + melted + drifted; }
};

}  // namespace snowbough::snow
