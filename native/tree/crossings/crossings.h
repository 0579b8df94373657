#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "base/parallel_for.h"
#include "tree/crossings/fingerprints.h"
#include "tree/surface/surface.h"

namespace snowbough::tree {

/// Pairs of intersecting faces, per junction of the surface (in its order).
using JunctionCrossings = std::vector<std::vector<std::pair<int32_t, int32_t>>>;

/// Finds intersecting faces near the junctions: for each, all pairs of faces within two edges of
/// its knuckle (faces at the knuckle, their neighbours, and the neighbours of those; neighbours
/// share a vertex). Quads count as two triangles, split from corner 0 to 2, in floats; the test is
/// exact.
/// @param only per junction, 0 skips it; empty = all.
/// @param memo results of an earlier surface of the same skeleton: junctions whose surroundings
///   have not changed are not searched again. Null: none.
JunctionCrossings find_crossings(const Surface& surface, const std::vector<uint8_t>& only = {},
                                 const base::Execution& execution = {},
                                 CrossingMemo* memo = nullptr);

/// Branches that were left out of the surface although find_crossings needs their faces; ascending.
std::vector<int32_t> missing_limbs(const Surface& surface, const std::vector<uint8_t>& only);

}  // namespace snowbough::tree
