#include "snow/movement/repose/tile_outlets.h"

#include "base/simd.h"
#include "shaders/lib/texel_repose.h"

namespace snowbough::snow {
namespace {

/// Sets the bounds of walls, and of no other cells; returns whether there is a wall.
SNOWBOUGH_WIDE bool bound_walls(const TileGround& ground, const TileSnow& snow, TilePlane& bound) {
  uint8_t walls = 0;
  for (size_t cell = 0; cell < static_cast<size_t>(kTileCells); ++cell) {
    walls |= snow.kind[cell] & kWall;
    const float bare = ground.z[cell];
    bound[cell] = (snow.kind[cell] & kWall) != 0 ? bare : shared::kUnbounded;
  }
  return walls != 0;
}

}  // namespace

void TileOutlets::begin_pose() {
  bound.fill(shared::kUnbounded);
}

void TileOutlets::begin_step(const TileGround& ground, const TileSnow& snow) {
  if (has_bounds) has_bounds = any_wall = bound_walls(ground, snow, bound);
  has_fresh_bounds = false;
  cuts.clear();
  rows_to_pass = kAllWindowRows;
}

void TileOutlets::set_kind(const TileGround& ground, const TileSnow& snow, size_t cell) {
  bound[cell] = snow.is_wall(cell) ? ground.z[cell] : shared::kUnbounded;
  if (snow.is_wall(cell)) has_bounds = true;
}

}  // namespace snowbough::snow
