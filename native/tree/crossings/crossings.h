#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "tree/surface/surface.h"

namespace snowbough::tree {

/// Pairs of intersecting faces, per junction of the surface (in its order).
using JunctionCrossings = std::vector<std::vector<std::pair<int32_t, int32_t>>>;

/// Finds intersecting faces near the junctions: for each, all pairs of faces within two edges of
/// its knuckle (faces at the knuckle, their neighbours, and the neighbours of those; neighbours
/// share a vertex). Quads count as two triangles, split from corner 0 to 2, in floats; the test is
/// exact (crossing_quads).
/// @param moved  per branch: 1 searches only pairs with a face of such a branch. Empty: all.
/// @param threads  that may share the work, 0 = one per core; does not change the result.
JunctionCrossings find_crossings(const Surface& surface, const std::vector<uint8_t>& moved = {},
                                 int threads = 0);

}  // namespace snowbough::tree
