#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "tree/surface/surface.h"

namespace snowbough::tree {

/// All pairs of quads that cross each other (faces_cross), the lower number first,
/// ascending.
/// @param only  the quads that are looked at.
/// @param changed  per quad of `quads`, 1: only pairs of which one is so marked. Empty: all.
/// @param threads  that may share the work, 0 = one a core; the result does not depend on them.
std::vector<std::pair<int32_t, int32_t>> crossing_quads(std::span<const glm::dvec3> vertices,
                                                        std::span<const Quad> quads,
                                                        std::span<const int32_t> only,
                                                        std::span<const uint8_t> changed = {},
                                                        int threads = 1);

}  // namespace snowbough::tree
