#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <utility>
#include <vector>

#include "snow/movement/repose/tile_snow.h"

namespace snowbough::snow {

/// All rows of a tile's window (TileWindow), which has one more.
inline constexpr uint64_t kAllWindowRows = 0x1FFFFFFFFu;

/// Bounds on the snow of a block's cells from lower outlets, the surface's open edges and walls:
/// see lower_tile_bounds.
struct TileOutlets {
  /// Whether any cell may be a wall in this pose.
  bool any_wall = false;
  /// Whether the bound of any cell is finite, and whether any was lowered since the last query.
  std::atomic<bool> has_bounds = false;
  std::atomic<bool> has_fresh_bounds = false;
  /// Rows of the tile's window whose bounds may have been lowered since they were last passed on,
  /// one bit each.
  std::atomic<uint64_t> rows_to_pass = kAllWindowRows;
  /// Maximum height in metres of the snow's surface.
  TilePlane bound;
  /// Cells whose snow was cut to the bound in the step, and the units cut off.
  std::vector<std::pair<int32_t, float>> cuts;

  /// Resets to no walls; begin_step must follow.
  void begin_pose() {
    any_wall = false;
    has_bounds = true;
  }
  /// Resets to no bounds.
  void begin_step() {
    if (has_bounds) bound.fill(shared::kUnbounded);
    has_bounds = has_fresh_bounds = false;
    cuts.clear();
    rows_to_pass = kAllWindowRows;
  }
};

}  // namespace snowbough::snow
