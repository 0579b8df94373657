#pragma once

#include <cstdint>
#include <vector>

namespace snowbough::snow {

/// Parts of a mesh that hang together: triangles that are joined by vertices they share.
struct Sheets {
  /// Per triangle: its sheet, numbered by their first triangles.
  std::vector<int32_t> sheet;
  int32_t count = 0;
};

/// `triangles`: three vertex indices each, at least 0 and below `vertex_count`. O(triangles).
Sheets find_sheets(const std::vector<int32_t>& triangles, int32_t vertex_count);

}  // namespace snowbough::snow
