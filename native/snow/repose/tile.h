#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <glm/vec2.hpp>
#include <memory>
#include <vector>

#include "snow/repose/links.h"

namespace snowbough::snow {

inline constexpr int32_t kTileCells = kReposeBlock * kReposeBlock;
inline constexpr uint8_t kWall = 1;
inline constexpr uint8_t kBack = 2;
inline constexpr uint8_t kUnknown = 4;
/// In ReposeTile::forward, beside the links: one across a seam ends at the cell.
inline constexpr uint8_t kAtSeam = 16;
/// All rows of a tile, a bit each.
inline constexpr uint32_t kAllRows = 0xFFFFFFFFu;
/// And those of its window (TileWindow), which has one more.
inline constexpr uint64_t kAllWindowRows = 0x1FFFFFFFFu;
static_assert(kReposeBlock == 32, "rows of a tile are bits of a uint32_t");

/// How steep snow may be: tangent of the angle of repose; see shared::held_slope for the cohesion,
/// in metres.
struct ReposeLimits {
  float slope = 0.0f;
  float cohesion = 0.0f;
  bool operator==(const ReposeLimits&) const = default;
};

/// What the rounds of repose reckon with in one block of a map: cells row by row. A cell without a
/// texel has an area of 0.
struct ReposeTile {
  using Plane = std::array<float, kTileCells>;
  using Bytes = std::array<uint8_t, kTileCells>;

  /// Whether the bare surface is that of the current pose, and whether the links are set up for it
  /// and for what their cells are.
  bool has_pose = false;
  bool has_links = false;
  /// Whether any texel takes snow on both sides; whether any cell holds any on the back.
  bool any_two_sided = false;
  bool any_back = false;
  /// Whether any cell is a wall, as the step begins.
  bool any_wall = false;
  /// Whether no cell has held any snow since the tile was covered last.
  bool is_bare = false;
  /// Whether the bound of any cell is finite, and whether any was lowered since it was last asked.
  std::atomic<bool> has_bounds = false;
  std::atomic<bool> has_fresh_bounds = false;
  /// Rows of the tile's window with bounds that may be lower than what was passed on of them when
  /// they were looked at last: a bit each.
  std::atomic<uint64_t> rows_to_pass = kAllWindowRows;
  /// Rows with links that are to be looked at, since a surface beside them has changed, and rows
  /// with links along which snow flows: a bit each. In all others nothing would flow.
  std::atomic<uint32_t> active_rows = 0;
  uint32_t flowing = 0;
  /// Rows with links along which snow would flow, but not a whole unit.
  uint32_t partial_rows = 0;
  /// Rows with surfaces at seams that have changed, a bit each.
  std::atomic<uint32_t> active_rows_at_seams = 0;
  /// Rows in which snow has moved since the step began, and rows of `flow` that rounds have written
  /// to: a bit each.
  std::atomic<uint32_t> moved_rows = 0;
  uint32_t flow_rows = 0;

  /// The bare surface: a point of it in metres, from the object's anchor, the upward part of its
  /// normal, the same for the capacity, covered area in m2; the links of ReposeLinks::forward with
  /// kAtSeam; and the links that the texel has, at least kLinks.
  Plane x, y, z, normal_z, up, area;
  /// Sum of its principal curvatures in 1/m.
  Plane curvature;
  Bytes forward, links;
  /// Not 0: the texel takes snow on both sides.
  Bytes two_sided;

  /// kWall: it holds nothing; kBack: snow lies or would lie against the normal.
  Bytes kind;
  /// Units of volume when the step began, and what has come since: whole numbers.
  Plane held;
  std::array<double, kTileCells> moved;
  /// Height of the snow's surface in metres, how much a unit lifts it (0 on walls), and the units
  /// that a cell has to give: walls give nothing.
  Plane top, lift, gives;
  /// Metres that the snow's surface may reach, for what lies lower: see lower_tile_bounds.
  Plane bound;
  /// Of the links to the forward neighbours: shared::link_limit (infinite: there is none).
  std::array<Plane, kForwardLinks> limit;
  /// And given_flow of the last round; null before any is done.
  std::unique_ptr<std::array<Plane, kForwardLinks>> flow;

  /// No surface, links to none, kinds unknown.
  void begin_pose();
  /// Takes a cell's snow, `height` (signed) metres on the current pose, as the step begins. `unit`:
  /// see ReposeSurface. Returns whether the cell is of another kind than it was.
  bool cover(size_t cell, float height, float unit);
  /// The same for the cells of the first `size` (columns, rows); `height`: of the first of them,
  /// rows are `pitch` numbers apart.
  bool cover_rows(const float* height, size_t pitch, glm::ivec2 size, float unit);
  /// Forgets what moved in the step before. `bare`: no snow lies in the tile.
  void begin_step(bool bare = false);

  /// Whether snow has moved since the step began.
  bool has_moved() const { return moved_rows.load(std::memory_order_relaxed) != 0; }
  /// Whether anything may flow.
  bool is_active() const { return (active_rows.load(std::memory_order_relaxed) | flowing) != 0; }
  /// Metres by which a unit lifts a cell's surface, times its links: see shared::link_rate.
  float stiffness(size_t cell) const {
    return lift[cell] / (1.0f / static_cast<float>(links[cell]));
  }
  /// Lets units come to a cell.
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
  /// Takes away what lies over the bounds; returns whether there was any.
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
  /// By how much it is under its limit where the texel is bare.
  float slack = 0.0f;
};

/// What a tile's rounds did.
struct TileRounds {
  int rounds = 0;
  /// Whether snow still flowed in the last round, and whether any did in one.
  bool flows = false;
  bool has_changed = false;
};

/// Sets up the links that a block's cells keep, on tiles that are covered.
void set_up_tile_links(const ReposeTiles& tiles, int32_t block, int32_t blocks_a_side,
                       const ReposeLimits& limits);

/// What lower_tile_bounds did: whether bounds changed that bound others, and which tiles around
/// look at any of these, a bit each (TileWindow::seen_by).
struct TileBounds {
  bool has_changed = false;
  uint32_t seen_by = 0;
};

/// How high snow can lie over an outlet, which is a rim or a wall, over which it falls. At the
/// outlet its surface is bounded by the link's limit; where that cuts snow, the snow behind it
/// falls after it, so that it is bounded too, and so on inwards: a cascade that rounds of flow
/// would need a round for every texel of. Bounds only get lower and come to the same numbers in any
/// order. Tiles must have been set up; those next to each other not at one time.
TileBounds lower_tile_bounds(const ReposeTiles& tiles, int32_t block, int32_t blocks_a_side,
                             const std::vector<RimLink>& rims);

/// Lets snow move for at most `rounds` rounds along the links of a block's cells, as many as are
/// needed until it rests: in rows that are stirred or flowing, and in those that they stir.
/// `first_round`: for the momentum. Neighbouring tiles' cells beside the block change with it, so
/// tiles next to each other must not do their rounds at one time; every second one of a row or
/// column may.
TileRounds run_tile_rounds(const ReposeTiles& tiles, int32_t block, int32_t blocks_a_side,
                           std::vector<RimLink>& rims, int first_round, int rounds);

}  // namespace snowbough::snow
