#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>

#include "snow/movement/repose/tile_ground.h"

namespace snowbough::snow {

/// The links of a block's cells to their forward neighbours: their limits, the flow along them, and
/// the rows in which anything may flow, one bit each.
struct TileLinks {
  /// Whether the limits are of the current pose and kinds of the cells.
  bool has_limits = false;
  /// Active rows, whose links must be evaluated because an adjacent surface has changed; and rows
  /// along whose links snow flows. Nothing flows in other rows.
  std::atomic<uint32_t> active_rows = 0;
  uint32_t flowing = 0;
  /// Rows along whose links less than a whole unit would flow.
  uint32_t partial_rows = 0;
  /// Rows with changed surfaces at seams.
  std::atomic<uint32_t> active_rows_at_seams = 0;
  /// The tangent of the angle of repose of grains, see granular.h; 0: the limits stay.
  float granular_slope = 0.0f;
  /// Rows of `flow` that rounds have written.
  uint32_t flow_rows = 0;
  /// shared::link_limit in metres (kNoLink: no link).
  std::array<TilePlane, kForwardLinks> limit;
  /// shared::given_flow of the last round; null before the first.
  std::unique_ptr<std::array<TilePlane, kForwardLinks>> flow;

  /// Makes all rows active without flow. `keeps_flow`: keep its memory.
  void begin_step(bool keeps_flow);
  /// Whether anything may flow.
  bool is_active() const { return (active_rows.load(std::memory_order_relaxed) | flowing) != 0; }
};

/// A link from a cell over an open edge, or onto a wall: an outlet.
struct OutletLink {
  int32_t cell = 0;
  /// Of the outlet: its link in ReposeLinks, as ReposeLinks::End::link, or -1 - the place of a wall
  /// that is beside the cell on the map. And the cell's texel, unless it is such a wall's.
  int32_t number = 0;
  int32_t texel = 0;
  /// Height in metres of the surface's end; and of what the snow above it rests against, which is
  /// higher if snow lies beyond.
  float bare = 0.0f;
  float top = 0.0f;
  /// Height in metres of a wall's upper end above `bare`.
  float rise = 0.0f;
  float limit = 0.0f;
  float rate = 0.0f;
  float flow = 0.0f;
  /// Units that have fallen over it in the step.
  double fallen = 0.0;
};

}  // namespace snowbough::snow
