#pragma once

#include <cstdint>

#include "snow/movement/rays/scene_rays.h"
#include "snow/movement/repose/ground.h"
#include "snow/movement/repose/link_limits.h"
#include "snow/movement/repose/tile.h"

namespace snowbough::snow {

/// Cells whose state has changed: the blocks that have one or a neighbour of one, by row and column
/// from -1 to 1, bit 3 * (row + 1) + column + 1; and whether any is at a seam.
struct ChangedCells {
  uint32_t around = 0;
  bool is_at_seam = false;

  bool any() const { return around != 0; }
  void add(int32_t column, int32_t row) {
    const int32_t low_x = column == 0 ? -1 : 0, high_x = column == kReposeBlock - 1 ? 1 : 0;
    const int32_t low_y = row == 0 ? -1 : 0, high_y = row == kReposeBlock - 1 ? 1 : 0;
    for (int32_t y = low_y; y <= high_y; ++y) {
      for (int32_t x = low_x; x <= high_x; ++x)
        around |= 1u << static_cast<uint32_t>(3 * y + x + 4);
    }
  }
};

/// Finds the room above a block's texels onto which snow may flow, and marks those whose room is
/// full; returns those for which that has changed. It depends on this step's snow only.
ChangedCells fill_rooms(ReposeGround& ground, const SceneRays& rays, const ReposeLimits& limits,
                        const ReposeTiles& tiles, int32_t block);

/// Marks no texel as full; returns which were.
ChangedCells clear_rooms(ReposeTile& tile);

}  // namespace snowbough::snow
