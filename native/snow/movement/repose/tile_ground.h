#pragma once

#include <array>
#include <cstdint>

#include "shaders/lib/texel_repose.h"
#include "snow/movement/repose/links.h"

namespace snowbough::snow {

/// One number, or byte, per cell of a block, row by row.
using TilePlane = std::array<float, kTileCells>;
using TileBytes = std::array<uint8_t, kTileCells>;

/// In TileGround::forward, beside the links: a link across a seam ends at the cell.
inline constexpr uint8_t kAtSeam = 16;

/// The bare surface of a block's cells in a pose; it stays while the object does not move. A cell
/// without a texel has area 0.
struct TileGround {
  /// Whether it is of the current pose.
  bool has_pose = false;
  /// Whether any texel takes snow on both sides.
  bool any_two_sided = false;
  /// Points in metres, relative to the object's anchor.
  TilePlane x, y, z;
  /// Upward part of the shading normal; the same for the capacity (shaders/lib/texel_surface.h).
  TilePlane normal_z, up;
  /// Covered area in m2.
  TilePlane area;
  /// Sum of the principal curvatures in 1/m.
  TilePlane curvature;
  /// ReposeLinks::forward with kAtSeam.
  TileBytes forward;
  /// Number of the texel's links of all kinds, at least kLinks.
  TileBytes link_count;
  /// Not 0: the texel takes snow on both sides.
  TileBytes two_sided;
  /// Vertical distance in metres to the first surface above, infinite under the sky, 0 within a
  /// body; negative: not known.
  TilePlane room;
  /// The same to the object's own surface; kept while a rigid body turns about the vertical or
  /// moves along, so that it needs no rays.
  TilePlane own_room;

  void forget_rooms() { room.fill(-1.0f); }
  /// Resets to no surface and no links, in the current pose.
  void begin_pose() {
    x = y = z = normal_z = up = area = curvature = {};
    forward.fill(0);
    two_sided.fill(0);
    forget_rooms();
    own_room.fill(-1.0f);
    link_count.fill(static_cast<uint8_t>(shared::kLinks));
    has_pose = true;
    any_two_sided = false;
  }
};

}  // namespace snowbough::snow
