#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "snow/repose/links.h"

namespace snowbough::snow {

inline constexpr int32_t kTileCells = kReposeBlock * kReposeBlock;
inline constexpr uint8_t kWall = 1;
inline constexpr uint8_t kBack = 2;
inline constexpr uint8_t kUnknown = 4;

/// What the rounds of repose reckon with in one block of a map: cells row by row. A cell without a
/// texel has an area of 0.
struct ReposeTile {
  using Plane = std::array<float, kTileCells>;

  /// The bare surface: a point of it in metres, from the object's anchor, the upward part of its
  /// normal, the same for the capacity, covered area in m2; the links of ReposeLinks::forward; and
  /// 1 / (links that the texel has, at least kLinks).
  Plane x, y, z, normal_z, up, area, part;
  std::array<uint8_t, kTileCells> forward;
  /// Not 0: the texel takes snow on both sides.
  std::array<uint8_t, kTileCells> two_sided;
  /// Whether the above is that of the current pose, and whether the links are set up for it and for
  /// what their cells are.
  bool has_pose = false;
  bool has_links = false;

  /// kWall: it holds nothing; kBack: snow lies or would lie against the normal.
  std::array<uint8_t, kTileCells> kind;
  /// Units of volume when the step began, and what has come since: whole numbers.
  Plane held;
  std::array<double, kTileCells> moved;
  /// Height of the snow's surface in metres, how much a unit lifts it, whether a texel gives
  /// anything (1, walls 0), and the units that it has to give; how stiff it is for link_rate; and
  /// units in a metre of snow.
  Plane top, lift, share, gives, stiffness, units_a_metre;
  /// Metres that the snow's surface may reach, for what lies lower: see lower_tile_bounds.
  Plane bound;
  /// Of the links to the forward neighbours: shared::link_limit (infinite: there is none),
  /// link_rate and given_flow.
  std::array<Plane, kForwardLinks> limit, rate, flow;

  /// No surface, links to none, kinds unknown.
  void begin_pose();
  /// Takes a cell's snow, `height` (signed) metres on the current pose, as the step begins. `unit`:
  /// see ReposeSurface. Returns whether the cell is of another kind than it was.
  bool cover(size_t cell, float height, float unit);
  void set_kind(size_t cell, uint8_t now, float unit);
  /// Brings top and gives up to date.
  void raise(size_t cell) {
    const float now = held[cell] + static_cast<float>(moved[cell]);
    top[cell] = z[cell] + lift[cell] * now;
    gives[cell] = now > 0.0f ? share[cell] * now : 0.0f;
  }
  /// Takes away what lies over the bounds; returns whether there was any.
  bool cut();
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
  /// Whether snow still flowed in the last round, whether any did in one, and whether cells changed
  /// that neighbouring tiles look at.
  bool flows = false;
  bool has_changed = false;
  bool border_has_changed = false;
};

/// Sets up the links that a block's cells keep, on tiles that are covered. `slope`: tangent of the
/// angle of repose.
void set_up_tile_links(const ReposeTiles& tiles, int32_t block, int32_t blocks_a_side, float slope);

/// What lower_tile_bounds did: whether bounds changed, and whether any that other tiles look at.
struct TileBounds {
  bool has_changed = false;
  bool border_has_changed = false;
};

/// How high snow can lie over an outlet, which is a rim or a wall, over which it falls. At the
/// outlet its surface is bounded by the link's limit; where that cuts snow, the snow behind it
/// falls after it, so that it is bounded too, and so on inwards: a cascade that rounds of flow
/// would need a round for every texel of. Bounds only get lower and come to the same numbers in any
/// order. Tiles must have been set up; those next to each other not at one time.
TileBounds lower_tile_bounds(const ReposeTiles& tiles, int32_t block, int32_t blocks_a_side,
                             const std::vector<RimLink>& rims);

/// Whether no link of a block's cells is over its limit.
bool is_at_rest(const ReposeTiles& tiles, int32_t block, int32_t blocks_a_side,
                const std::vector<RimLink>& rims);

/// Lets snow move for at most `rounds` rounds along the links of a block's cells, as many as are
/// needed until it rests. `first_round`: for the momentum. Neighbouring tiles' cells beside the
/// block change with it, so tiles next to each other must not do their rounds at one time; every
/// second one of a row or column may.
TileRounds run_tile_rounds(const ReposeTiles& tiles, int32_t block, int32_t blocks_a_side,
                           std::vector<RimLink>& rims, int first_round, int rounds);

}  // namespace snowbough::snow
