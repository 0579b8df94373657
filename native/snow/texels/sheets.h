#pragma once

#include <cstdint>
#include <vector>

namespace snowbough::snow {

/// Connected components of a mesh: triangles joined by shared vertices.
struct Sheets {
  /// Per triangle: its sheet, numbered in the order of first triangles.
  std::vector<int32_t> sheet;
  int32_t count = 0;
};

/// `triangles`: three vertex indices each, at least 0 and below `vertex_count`. O(triangles).
Sheets find_sheets(const std::vector<int32_t>& triangles, int32_t vertex_count);

}  // namespace snowbough::snow
