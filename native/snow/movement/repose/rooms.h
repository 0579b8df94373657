#pragma once

#include <cstdint>

#include "snow/movement/rays/scene_rays.h"
#include "snow/movement/repose/ground.h"
#include "snow/movement/repose/link_limits.h"
#include "snow/movement/repose/tile.h"

namespace snowbough::snow {

/// Finds the room above a block's texels onto which snow may flow, and marks those whose room is
/// full; returns whether that has changed for any. It depends on this step's snow only.
bool fill_rooms(ReposeGround& ground, const SceneRays& rays, const ReposeLimits& limits,
                const ReposeTiles& tiles, int32_t block);

/// Marks no texel as full; returns whether any was.
bool clear_rooms(ReposeTile& tile);

}  // namespace snowbough::snow
