#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "base/parallel_for.h"
#include "tree/crossings/fingerprints.h"
#include "tree/surface/surface.h"

namespace snowbough::tree {

/// Pairs of faces that intersect each other, per junction of the surface (in its order).
using JunctionCrossings = std::vector<std::vector<std::pair<int32_t, int32_t>>>;

/// Looks for faces that cross near the junctions: for each, all pairs of faces within two edges of
/// its knuckle (faces that touch the knuckle, their neighbours, and the neighbours of those;
/// neighbours share a vertex). Quads count as two triangles, cut from corner 0 to 2, as floats; the
/// test is exact.
/// @param only per junction, 0 skips it; empty = look at all.
/// @param memo what was found in a surface of the same skeleton before: junctions around which
///   nothing has moved since are not searched again. Null: none.
JunctionCrossings find_crossings(const Surface& surface, const std::vector<uint8_t>& only = {},
                                 const base::Execution& execution = {},
                                 CrossingMemo* memo = nullptr);

/// Branches that the surface was built without and whose faces belong to what find_crossings looks
/// at; ascending.
std::vector<int32_t> missing_limbs(const Surface& surface, const std::vector<uint8_t>& only);

}  // namespace snowbough::tree
