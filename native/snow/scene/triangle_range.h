#pragma once

#include <cstdint>

namespace snowbough::snow {

/// A run of triangles to draw.
struct TriangleRange {
  int32_t first = 0;
  int32_t count = 0;
  /// Whether they may have holes, and then what leads from their index to that of their alpha.
  bool has_alpha = false;
  int32_t alpha_offset = 0;
};

}  // namespace snowbough::snow
