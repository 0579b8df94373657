#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>

#include "snow/movement/repose/tile_ground.h"

namespace snowbough::snow {

/// Bits of TileSnow::kind: the cell holds no snow; snow lies, or would lie, against the normal; not
/// known yet; snow fills the room below another surface, so that nothing moves.
inline constexpr uint8_t kWall = 1;
inline constexpr uint8_t kBack = 2;
inline constexpr uint8_t kUnknown = 4;
inline constexpr uint8_t kFull = 8;

/// The snow on a block's cells: its volume in whole units (ReposeSurface::unit), what has come and
/// gone in the step, and the height of its surface.
struct TileSnow {
  /// Whether any cell holds snow on the back.
  bool any_back = false;
  /// Whether any cell is full.
  bool any_full = false;
  /// Whether no cell has held snow since the tile was last covered.
  bool is_bare = false;
  /// Rows in which snow has moved since the step began, one bit each.
  std::atomic<uint32_t> moved_rows = 0;
  TileBytes kind;
  /// Units at the start of the step, and those that have come since.
  TilePlane held;
  std::array<double, kTileCells> moved;
  /// Height of the snow's surface in metres, its rise per unit (0 on walls), and the units that a
  /// cell can give (0 on walls).
  TilePlane top, lift, gives;

  /// Resets to unknown kinds without snow.
  void begin_pose();
  /// Clears the movement of the previous step. `bare`: no snow lies in the tile.
  void begin_step(bool bare);
  /// Sets a cell's snow at the start of the step, `height` (signed) metres. Returns whether the
  /// cell's kind changed. `unit`: see ReposeSurface.
  bool cover(const TileGround& ground, size_t cell, float height, float unit);
  /// The same for the first `size` cells (columns, rows), whose kinds must stay; `height`: of the
  /// first cell, with rows `pitch` numbers apart. Returns whether any lies on the back.
  bool cover_rows(const TileGround& ground, const float* height, size_t pitch, glm::ivec2 size,
                  float unit);

  bool is_full(size_t cell) const { return (kind[cell] & kFull) != 0; }
  bool is_wall(size_t cell) const { return (kind[cell] & kWall) != 0; }
  /// Whether snow has moved since the step began.
  bool has_moved() const { return moved_rows.load(std::memory_order_relaxed) != 0; }
  /// Adds units to a cell over bare ground at `z` metres.
  void add(size_t cell, double units, float z) {
    moved[cell] += units;
    const float now = held[cell] + static_cast<float>(moved[cell]);
    top[cell] = z + lift[cell] * now;
    gives[cell] = now > 0.0f && lift[cell] > 0.0f ? now : 0.0f;
    const uint32_t row = 1u << (cell / kReposeBlock);
    if ((moved_rows.load(std::memory_order_relaxed) & row) == 0) {
      moved_rows.fetch_or(row, std::memory_order_relaxed);
    }
  }
};

}  // namespace snowbough::snow
