// The links of a tile: their limits, and the metrics of its quads.
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
  /// 1 where a cell is linked with the one to its right, and with the one above.
  TileWindow::Plane right, above;
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

/// The metrics of a row of quads, of which the cells at `at` are the first corners.
SNOWBOUGH_WIDE void set_up_quads(const Bare& bare, size_t at, const ReposeLimits& limits,
                                 float* __restrict uu, float* __restrict uv, float* __restrict vv) {
  // Parts of a quad's size below which it has none: seen from above, it is a line.
  constexpr float kFlat = 1e-5f;
  constexpr int32_t kUp = TileWindow::kStride;
  const float* const x = bare.x.data() + at;
  const float* const y = bare.y.data() + at;
  const float* const area = bare.area.data() + at;
  const float* const curvature = bare.curvature.data() + at;
  const float* const wall = bare.wall.data() + at;
  const float* const right = bare.right.data() + at;
  const float* const above = bare.above.data() + at;
  const float slope_at_rest = limits.slope;
  const float cohesion = limits.cohesion;
  for (int32_t i = 0; i < kReposeBlock; ++i) {
    const int32_t e = i + 1;
    const int32_t n = i + kUp;
    const int32_t ne = n + 1;
    const float along_x = 0.5f * ((x[e] - x[i]) + (x[ne] - x[n]));
    const float along_y = 0.5f * ((y[e] - y[i]) + (y[ne] - y[n]));
    const float across_x = 0.5f * ((x[n] - x[i]) + (x[ne] - x[e]));
    const float across_y = 0.5f * ((y[n] - y[i]) + (y[ne] - y[e]));
    const float along = along_x * along_x + along_y * along_y;
    const float across = across_x * across_x + across_y * across_y;
    const float mixed = along_x * across_x + along_y * across_y;
    const float size = along * across - mixed * mixed;
    const float mean_curvature =
        0.25f * ((curvature[i] + curvature[e]) + (curvature[n] + curvature[ne]));
    const float slope =
        shared::kEven * shared::held_slope(slope_at_rest, cohesion, mean_curvature);
    const bool is_there = (area[i] > 0.0f) & (area[e] > 0.0f) & (area[n] > 0.0f) &
                          (area[ne] > 0.0f) & (wall[i] + wall[e] + wall[n] + wall[ne] == 0.0f) &
                          (right[i] + right[n] + above[i] + above[e] == 4.0f) &
                          (size > kFlat * along * across);
    const float scale = is_there ? 1.0f / (slope * slope * size) : 0.0f;
    uu[i] = across * scale;
    uv[i] = -mixed * scale;
    vv[i] = along * scale;
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
            const uint8_t links = tile != nullptr ? tile->forward[cell + i] : 0;
            bare.steep[at + i] = shared::bare_slope(tile != nullptr ? tile->up[cell + i] : 1.0f);
            bare.wall[at + i] = (kind & kWall) != 0 ? 1.0f : 0.0f;
            bare.right[at + i] = (links & 1) != 0 ? 1.0f : 0.0f;
            bare.above[at + i] = (links & 2) != 0 ? 1.0f : 0.0f;
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
    set_up_quads(bare, TileWindow::at(0, row), limits, tile.quad_uu.data() + cells,
                 tile.quad_uv.data() + cells, tile.quad_vv.data() + cells);
  }
}

}  // namespace snowbough::snow
