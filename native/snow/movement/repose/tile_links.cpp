#include "snow/movement/repose/tile_links.h"

#include <algorithm>
#include <array>
#include <bit>

#include "base/simd.h"
#include "shaders/lib/texel_repose.h"
#include "snow/movement/repose/link_limits.h"
#include "snow/movement/repose/tiles_around.h"

namespace snowbough::snow {
namespace {

/// Converts the upward parts of the normals of a window's row to slopes.
SNOWBOUGH_WIDE void find_slopes(float* __restrict up) {
  for (int32_t i = 0; i < kReposeBlock + 2; ++i) up[i] = shared::bare_slope(up[i]);
}

/// 1 for kinds that are walls, else 0.
SNOWBOUGH_WIDE void find_walls(const uint8_t* __restrict kind, size_t count,
                               float* __restrict wall) {
  for (size_t i = 0; i < count; ++i) wall[i] = (kind[i] & kWall) != 0 ? 1.0f : 0.0f;
}

void load_row(const TilesAround& around, int32_t row, BareWindow& bare) {
  around.copy_row(row, &ReposeTile::ground, &TileGround::x, bare.x, 0.0f);
  around.copy_row(row, &ReposeTile::ground, &TileGround::y, bare.y, 0.0f);
  around.copy_row(row, &ReposeTile::ground, &TileGround::z, bare.z, 0.0f);
  around.copy_row(row, &ReposeTile::ground, &TileGround::area, bare.area, 0.0f);
  around.copy_row(row, &ReposeTile::ground, &TileGround::curvature, bare.curvature, 0.0f);
  around.copy_row(row, &ReposeTile::ground, &TileGround::up, bare.steep, 1.0f);
  find_slopes(&bare.steep[TileWindow::at(-1, row)]);
  around.for_row(row, [&](const ReposeTile* tile, size_t cell, int32_t column, size_t count) {
    float* const wall = bare.wall.data() + TileWindow::at(column, row);
    if (tile == nullptr) {
      std::fill_n(wall, count, 0.0f);
    } else {
      find_walls(tile->snow.kind.data() + cell, count, wall);
      // Full cells have no links.
      for (size_t i = 0; tile->snow.any_full && i < count; ++i) {
        if (tile->snow.is_full(cell + i)) bare.area[TileWindow::at(column, row) + i] = 0.0f;
      }
    }
  });
}

}  // namespace

void TileLinks::begin_step(bool keeps_flow) {
  if (!keeps_flow) flow.reset();
  for (uint32_t rows = flow != nullptr ? flow_rows : 0; rows != 0; rows &= rows - 1) {
    for (TilePlane& plane : *flow) {
      std::fill_n(plane.begin() + std::countr_zero(rows) * kReposeBlock, kReposeBlock, 0.0f);
    }
  }
  flow_rows = flowing = partial_rows = 0;
  active_rows = active_rows_at_seams = kAllRows;
}

void set_up_tile_links(const ReposeTiles& tiles, int32_t block, int32_t blocks_a_side,
                       const ReposeLimits& limits) {
  const TilesAround around(tiles, blocks_a_side, block);
  BareWindow bare;
  for (int32_t row = 0; row < TileWindow::kRows; ++row) load_row(around, row, bare);
  TileLinks& links = around.at(0, 0)->links;
  const TileBytes& forward = around.at(0, 0)->ground.forward;
  links.has_limits = true;
  links.granular_slope = limits.is_granular ? limits.slope : 0.0f;
  for (int32_t row = 0; row < kReposeBlock; ++row) {
    const auto first = static_cast<size_t>(row * kReposeBlock);
    std::array<float*, kForwardLinks> limit;
    for (size_t k = 0; k < limit.size(); ++k) limit[k] = &links.limit[k][first];
    find_link_limits(bare, row, &forward[first], limits, limit.data());
  }
}

}  // namespace snowbough::snow
