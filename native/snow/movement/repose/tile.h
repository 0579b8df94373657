#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "snow/movement/repose/link_limits.h"
#include "snow/movement/repose/tile_ground.h"
#include "snow/movement/repose/tile_links.h"
#include "snow/movement/repose/tile_outlets.h"
#include "snow/movement/repose/tile_snow.h"

namespace snowbough::snow {

/// Repose data of one block of a map, in parts by what they describe: the ground changes with the
/// pose, the bounds from outlets once per step, snow and links with every round.
/// shaders/lib/texel_repose.h has the method.
struct ReposeTile {
  TileGround ground;
  TileSnow snow;
  TileLinks links;
  TileOutlets outlets;

  /// Resets to no surface, no links and unknown kinds.
  void begin_pose();
  /// Sets a cell's snow at the start of the step: TileSnow::cover. Returns whether the cell's kind
  /// changed.
  bool cover(size_t cell, float height, float unit);
  /// The same for the first `size` cells (columns, rows); `height`: of the first cell, with rows
  /// `pitch` numbers apart.
  bool cover_rows(const float* height, size_t pitch, glm::ivec2 size, float unit);
  /// Begins a step after its snow has been set. `bare`: no snow lies in the tile.
  void begin_step(bool bare = false);

  /// Rise in metres of a cell's surface per unit, times its links: see shared::link_rate.
  float stiffness(size_t cell) const {
    return snow.lift[cell] / (1.0f / static_cast<float>(ground.link_count[cell]));
  }
  /// Adds units to a cell.
  void add(size_t cell, double units) {
    snow.add(cell, units, ground.z[cell]);
    if ((ground.forward[cell] & kAtSeam) != 0) {
      links.active_rows_at_seams.fetch_or(1u << (cell / kReposeBlock), std::memory_order_relaxed);
    }
  }
  /// Removes snow above the bounds; returns whether there was any.
  bool cut();
};

/// Tiles by block; null where there is none.
using ReposeTiles = std::vector<std::unique_ptr<ReposeTile>>;

/// Result of a tile's rounds.
struct TileRounds {
  int rounds = 0;
  /// Whether snow still flowed in the last round, and whether any flowed in one.
  bool flows = false;
  bool has_changed = false;
};

/// Sets up the links of a block's cells, on covered tiles.
void set_up_tile_links(const ReposeTiles& tiles, int32_t block, int32_t blocks_a_side,
                       const ReposeLimits& limits);

/// Result of lower_tile_bounds: whether bounds changed that affect others, and the tiles around
/// that read them, one bit each (TileWindow::seen_by).
struct TileBounds {
  bool has_changed = false;
  uint32_t seen_by = 0;
};

/// Bounds the snow above an outlet (an open edge or wall over which snow falls). At the outlet the
/// link's limit bounds the surface; where that removes snow, the snow behind it falls too and is
/// bounded in turn, and so on inwards: a cascade for which rounds of flow would need one round per
/// texel. Bounds only decrease and converge to the same numbers in any order. Tiles must be set up;
/// adjacent tiles must not run at the same time.
TileBounds lower_tile_bounds(const ReposeTiles& tiles, int32_t block, int32_t blocks_a_side,
                             const std::vector<OutletLink>& outlet_links);

/// Moves snow along the links of a block's cells until it rests, for at most `rounds` rounds: in
/// active and flowing rows, and in rows that these activate. `first_round`: for the momentum. It
/// also changes neighbouring tiles' cells beside the block, so adjacent tiles must not run at the
/// same time; every second one of a row or column may.
TileRounds run_tile_rounds(const ReposeTiles& tiles, int32_t block, int32_t blocks_a_side,
                           std::vector<OutletLink>& outlet_links, int first_round, int rounds);

}  // namespace snowbough::snow
