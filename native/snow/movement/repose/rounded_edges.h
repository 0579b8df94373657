#pragma once

#include <cstdint>
#include <vector>

#include "snow/movement/repose/ground.h"
#include "snow/movement/repose/outlets.h"

namespace snowbough::snow {

/// Raises a block's outlets below bevels and roundings that are low against the snow: it lies over
/// them as over sharp edges. `deepest`: of the map's snow, in metres; `height`: of the object's own
/// map. Edges are searched once in a pose: `ground.edges` must have a place for each block.
void raise_rounded_edges(ReposeGround& ground, float deepest, int32_t block,
                         const std::vector<float>& height, ReposeBlocks& map);

}  // namespace snowbough::snow
