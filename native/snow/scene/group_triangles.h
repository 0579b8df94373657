#pragma once

#include <cstdint>
#include <vector>

#include "snow/texels/texel_table.h"

namespace snowbough::snow {

/// The triangles that decide whether a work group of texels is active: those on its texels.
struct GroupTriangles {
  /// Triangles of group g: [begin[g], begin[g + 1]), ascending, numbers within the scene.
  std::vector<uint32_t> begin{0};
  std::vector<uint32_t> triangles;
};

/// Appends the groups of one receiver, whose triangles begin at `first_triangle` of the scene.
/// `order`: its texels from texel_order, which start a new group. O(fragments).
void add_group_triangles(const TexelTable& table, const std::vector<int32_t>& order,
                         uint32_t first_triangle, GroupTriangles& groups);

}  // namespace snowbough::snow
