#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <glm/vec2.hpp>
#include <memory>
#include <vector>

#include "snow/repose/link_limits.h"
#include "snow/repose/links.h"

namespace snowbough::snow {

inline constexpr uint8_t kWall = 1;
inline constexpr uint8_t kBack = 2;
inline constexpr uint8_t kUnknown = 4;
/// In ReposeTile::forward, beside the links: a link across a seam ends at the cell.
inline constexpr uint8_t kAtSeam = 16;
/// All rows of its window (TileWindow), which has one more.
inline constexpr uint64_t kAllWindowRows = 0x1FFFFFFFFu;

/// Repose data of one block of a map: cells row by row. A cell without a texel has area 0.
struct ReposeTile {
  using Plane = std::array<float, kTileCells>;
  using Bytes = std::array<uint8_t, kTileCells>;

  /// Whether the bare surface is of the current pose, and whether the links are set up for it and
  /// for the kinds of the cells.
  bool has_pose = false;
  bool has_links = false;
  /// Whether any texel takes snow on both sides; whether any cell holds snow on the back.
  bool any_two_sided = false;
  bool any_back = false;
  /// Whether any cell is a wall at the start of the step.
  bool any_wall = false;
  /// Whether no cell has held snow since the tile was last covered.
  bool is_bare = false;
  /// Whether the bound of any cell is finite, and whether any was lowered since the last query.
  std::atomic<bool> has_bounds = false;
  std::atomic<bool> has_fresh_bounds = false;
  /// Rows of the tile's window whose bounds may have been lowered since they were last passed on,
  /// one bit each.
  std::atomic<uint64_t> rows_to_pass = kAllWindowRows;
  /// Active rows, whose links must be evaluated because an adjacent surface has changed; and rows
  /// along whose links snow flows. One bit each; nothing flows in other rows.
  std::atomic<uint32_t> active_rows = 0;
  uint32_t flowing = 0;
  /// Rows along whose links less than a whole unit would flow.
  uint32_t partial_rows = 0;
  /// Rows with changed surfaces at seams, one bit each.
  std::atomic<uint32_t> active_rows_at_seams = 0;
  /// Rows in which snow has moved since the step began, and rows of `flow` that rounds have
  /// written: one bit each.
  std::atomic<uint32_t> moved_rows = 0;
  uint32_t flow_rows = 0;

  /// The bare surface: a point in metres, relative to the object's anchor; the upward part of the
  /// normal; the same for the capacity; covered area in m2; the links of ReposeLinks::forward with
  /// kAtSeam; and the number of the texel's links, at least kLinks.
  Plane x, y, z, normal_z, up, area;
  /// Sum of the principal curvatures in 1/m.
  Plane curvature;
  Bytes forward, links;
  /// Not 0: the texel takes snow on both sides.
  Bytes two_sided;

  /// kWall: holds no snow; kBack: snow lies, or would lie, against the normal.
  Bytes kind;
  /// Units of volume at the start of the step, and those that have come since: whole numbers.
  Plane held;
  std::array<double, kTileCells> moved;
  /// Height of the snow's surface in metres, its rise per unit (0 on walls), and the units that a
  /// cell can give (0 on walls).
  Plane top, lift, gives;
  /// Maximum height in metres of the snow's surface, from lower outlets: see lower_tile_bounds.
  Plane bound;
  /// Limits of the links to the forward neighbours: shared::link_limit (infinite: no link).
  std::array<Plane, kForwardLinks> limit;
  /// given_flow of the last round; null before the first.
  std::unique_ptr<std::array<Plane, kForwardLinks>> flow;

  /// Resets to no surface, no links and unknown kinds.
  void begin_pose();
  /// Sets a cell's snow at the start of the step, `height` (signed) metres on the current pose.
  /// `unit`: see ReposeSurface. Returns whether the cell's kind changed.
  bool cover(size_t cell, float height, float unit);
  /// The same for the first `size` cells (columns, rows); `height`: of the first cell, with rows
  /// `pitch` numbers apart.
  bool cover_rows(const float* height, size_t pitch, glm::ivec2 size, float unit);
  /// Clears the movement of the previous step. `bare`: no snow lies in the tile.
  void begin_step(bool bare = false);

  /// Whether snow has moved since the step began.
  bool has_moved() const { return moved_rows.load(std::memory_order_relaxed) != 0; }
  /// Whether anything may flow.
  bool is_active() const { return (active_rows.load(std::memory_order_relaxed) | flowing) != 0; }
  /// Rise in metres of a cell's surface per unit, times its links: see shared::link_rate.
  float stiffness(size_t cell) const {
    return lift[cell] / (1.0f / static_cast<float>(links[cell]));
  }
  /// Adds units to a cell.
  void add(size_t cell, double units) {
    moved[cell] += units;
    const float now = held[cell] + static_cast<float>(moved[cell]);
    top[cell] = z[cell] + lift[cell] * now;
    gives[cell] = now > 0.0f && lift[cell] > 0.0f ? now : 0.0f;
    const uint32_t row = 1u << (cell / kReposeBlock);
    if ((moved_rows.load(std::memory_order_relaxed) & row) == 0) {
      moved_rows.fetch_or(row, std::memory_order_relaxed);
    }
    if ((forward[cell] & kAtSeam) != 0) {
      active_rows_at_seams.fetch_or(row, std::memory_order_relaxed);
    }
  }
  /// Removes snow above the bounds; returns whether there was any.
  bool cut();

 private:
  void set_kind(size_t cell, uint8_t now, float unit);
};

/// Tiles by block; null where there is none.
using ReposeTiles = std::vector<std::unique_ptr<ReposeTile>>;

/// A link from a cell over a rim of the surface, or onto a wall beyond a seam.
struct RimLink {
  int32_t cell = 0;
  float top = 0.0f;
  float limit = 0.0f;
  float rate = 0.0f;
  float flow = 0.0f;
};

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

/// Bounds the snow above an outlet (a rim or wall over which snow falls). At the outlet the link's
/// limit bounds the surface; where that removes snow, the snow behind it falls too and is bounded
/// in turn, and so on inwards: a cascade for which rounds of flow would need one round per texel.
/// Bounds only decrease and converge to the same numbers in any order. Tiles must be set up;
/// adjacent tiles must not run at the same time.
TileBounds lower_tile_bounds(const ReposeTiles& tiles, int32_t block, int32_t blocks_a_side,
                             const std::vector<RimLink>& rims);

/// Moves snow along the links of a block's cells until it rests, for at most `rounds` rounds: in
/// active and flowing rows, and in rows that these activate. `first_round`: for the momentum. It
/// also changes neighbouring tiles' cells beside the block, so adjacent tiles must not run at the
/// same time; every second one of a row or column may.
TileRounds run_tile_rounds(const ReposeTiles& tiles, int32_t block, int32_t blocks_a_side,
                           std::vector<RimLink>& rims, int first_round, int rounds);

}  // namespace snowbough::snow
