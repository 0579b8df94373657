// The links of a tile: their limits.
#include <cmath>
#include <limits>

#include "base/simd.h"
#include "shaders/lib/texel_repose.h"
#include "snow/repose/tile.h"
#include "snow/repose/window.h"

namespace snowbough::snow {
namespace {

constexpr float kNoLink = std::numeric_limits<float>::infinity();

/// What the links of a block are set up from, cell by cell of a window.
struct alignas(64) Bare {
  TileWindow::Plane x, y, z, area, curvature;
  /// See shared::bare_slope.
  TileWindow::Plane steep;
  /// 1 on walls, else 0.
  TileWindow::Plane wall;
};

/// The limits of the links of a row of cells to those `step` cells away. Nothing moves on walls,
/// and what lies at the foot of one leans against it.
SNOWBOUGH_WIDE void set_up_row(const Bare& bare, size_t at, int32_t step, const uint8_t* forward,
                               int32_t k, const ReposeLimits& limits, float* __restrict limit) {
  const float* const x = bare.x.data() + at;
  const float* const y = bare.y.data() + at;
  const float* const z = bare.z.data() + at;
  const float* const steep = bare.steep.data() + at;
  const float* const area = bare.area.data() + at;
  const float* const curvature = bare.curvature.data() + at;
  const float* const wall = bare.wall.data() + at;
  const float slope_at_rest = limits.slope;
  const float cohesion = limits.cohesion;
  for (int32_t i = 0; i < kReposeBlock; ++i) {
    const int32_t j = i + step;
    const float way_x = x[j] - x[i];
    const float way_y = y[j] - y[i];
    const float falls = z[i] - z[j];
    const float steepness = 0.5f * (steep[i] + steep[j]);
    const float slope =
        shared::held_slope(slope_at_rest, cohesion, 0.5f * (curvature[i] + curvature[j]));
    const float way = std::sqrt(way_x * way_x + way_y * way_y);
    const float allowed = shared::link_limit(way, slope, falls, steepness, shared::kLeadsDown);
    // One of them a wall, and the other not over it; or both.
    const float over_wall = wall[j] > wall[i] ? falls : (wall[i] > wall[j] ? -falls : 1.0f);
    const bool is_open = (over_wall > 0.0f) & (wall[i] + wall[j] < 1.5f) & (area[i] > 0.0f) &
                         (area[j] > 0.0f) & (((forward[i] >> k) & 1) != 0);
    limit[i] = is_open ? allowed : kNoLink;
  }
}

}  // namespace

void set_up_tile_links(const ReposeTiles& tiles, int32_t block, int32_t blocks_a_side,
                       const ReposeLimits& limits) {
  const TilesAround around(tiles, blocks_a_side, block);
  Bare bare;
  for (int32_t row = 0; row < TileWindow::kRows; ++row) {
    TileWindow::copy_row(around, row, &ReposeTile::x, bare.x, 0.0f);
    TileWindow::copy_row(around, row, &ReposeTile::y, bare.y, 0.0f);
    TileWindow::copy_row(around, row, &ReposeTile::z, bare.z, 0.0f);
    TileWindow::copy_row(around, row, &ReposeTile::area, bare.area, 0.0f);
    TileWindow::copy_row(around, row, &ReposeTile::curvature, bare.curvature, 0.0f);
    TileWindow::for_row(
        around, row, [&](const ReposeTile* tile, size_t cell, int32_t column, size_t count) {
          const size_t at = TileWindow::at(column, row);
          for (size_t i = 0; i < count; ++i) {
            const uint8_t kind = tile != nullptr ? tile->kind[cell + i] : 0;
            bare.steep[at + i] = shared::bare_slope(tile != nullptr ? tile->up[cell + i] : 1.0f);
            bare.wall[at + i] = (kind & kWall) != 0 ? 1.0f : 0.0f;
          }
        });
  }
  ReposeTile& tile = *around.at(0, 0);
  tile.has_links = true;
  for (int32_t row = 0; row < kReposeBlock; ++row) {
    const auto cells = static_cast<size_t>(row * kReposeBlock);
    for (int32_t k = 0; k < kForwardLinks; ++k) {
      set_up_row(bare, TileWindow::at(0, row), TileWindow::step(k), tile.forward.data() + cells, k,
                 limits, tile.limit[static_cast<size_t>(k)].data() + cells);
    }
  }
}

}  // namespace snowbough::snow
