#pragma once

#include <cstdint>
#include <vector>

#include "snow/texel_table.h"

namespace snowbough::snow {

/// The triangles that decide whether a work group of texels has anything to do: those on its
/// texels, and those on texels of other groups beside them that are on the same chart, because a
/// pixel's snow may go to the texel beside the one that it hits.
struct GroupTriangles {
  /// Triangles of group g: [begin[g], begin[g + 1]), ascending, numbers within the scene.
  std::vector<uint32_t> begin{0};
  std::vector<uint32_t> triangles;
};

/// Appends the groups of one receiver. `order`: its texels as surface_order gives them, the first
/// at the beginning of a group. `owners`: per texel of its map, 1 + the texel's index in the map
/// group; 0 = nobody's. O(texels).
void add_group_triangles(const TexelTable& table, const std::vector<int32_t>& order,
                         const std::vector<uint32_t>& owners, uint32_t first_triangle,
                         GroupTriangles& groups);

}  // namespace snowbough::snow
