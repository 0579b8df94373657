#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "tree/surface/surface.h"

namespace snowbough::tree {

/// All pairs of intersecting quads (faces_cross), the lower index first, ascending.
/// @param only  the quads to test.
/// @param changed  per quad of `quads`: 1 tests only pairs with such a quad. Empty: all.
/// @param threads  that may share the work, 0 = one per core; does not change the result.
std::vector<std::pair<int32_t, int32_t>> crossing_quads(std::span<const glm::dvec3> vertices,
                                                        std::span<const Quad> quads,
                                                        std::span<const int32_t> only,
                                                        std::span<const uint8_t> changed = {},
                                                        int threads = 1);

}  // namespace snowbough::tree
