#pragma once

#include <cstdint>

namespace snowbough::snow {

/// A run of triangles to draw.
struct TriangleRange {
  int32_t first = 0;
  int32_t count = 0;
  /// Whether alpha may cut holes, and then the offset from a triangle's index to its alpha's.
  bool has_alpha = false;
  int32_t alpha_offset = 0;
};

}  // namespace snowbough::snow
