// Setting up the links of a tile: their limits.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/simd.h"
#include "shaders/lib/texel_repose.h"
#include "snow/repose/tile.h"
#include "snow/repose/window.h"

namespace snowbough::snow {
namespace {

constexpr float kNoLink = std::numeric_limits<float>::infinity();

/// Input for a block's links, cell by cell of a window.
struct alignas(64) Bare {
  TileWindow::Plane x, y, z, area, curvature;
  TileWindow::Plane steep;
  /// 1 on walls, else 0.
  TileWindow::Plane wall;
};

/// The limits of the links from a row of cells to those `step` cells away, if `linked` is 1, else
/// 0. Nothing moves on walls, and snow at the foot of a wall leans against it.
SNOWBOUGH_WIDE void set_up_row(const Bare& bare, size_t at, int32_t step,
                               const float* __restrict linked, const ReposeLimits& limits,
                               float* __restrict limit) {
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
    // The minimum of numbers that are positive where the link is open: mixing booleans would
    // prevent vectorisation. One cell may be a wall with the other above it; not both.
    const float over_wall = (wall[j] - wall[i]) * falls + (wall[j] == wall[i] ? 1.0f : 0.0f);
    const float there = std::min(std::min(area[i], area[j]), linked[i]);
    const float open = std::min(std::min(over_wall, there), 1.5f - (wall[i] + wall[j]));
    limit[i] = open > 0.0f ? allowed : kNoLink;
  }
}

/// Converts the upward parts of the normals of a window's row to slopes.
SNOWBOUGH_WIDE void find_slopes(float* __restrict up) {
  for (int32_t i = 0; i < kReposeBlock + 2; ++i) up[i] = shared::bare_slope(up[i]);
}

/// Converts bytes to 1 if they have the bit, else 0.
SNOWBOUGH_WIDE void spread_bit(const uint8_t* __restrict bytes, size_t count, uint8_t bit,
                               float* __restrict to) {
  for (size_t i = 0; i < count; ++i) to[i] = (bytes[i] & bit) != 0 ? 1.0f : 0.0f;
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
    TileWindow::copy_row(around, row, &ReposeTile::up, bare.steep, 1.0f);
    find_slopes(&bare.steep[TileWindow::at(-1, row)]);
    TileWindow::for_row(around, row,
                        [&](const ReposeTile* tile, size_t cell, int32_t column, size_t count) {
                          float* const wall = bare.wall.data() + TileWindow::at(column, row);
                          if (tile == nullptr) {
                            std::fill_n(wall, count, 0.0f);
                          } else {
                            spread_bit(tile->kind.data() + cell, count, kWall, wall);
                          }
                        });
  }
  ReposeTile& tile = *around.at(0, 0);
  tile.has_links = true;
  for (int32_t row = 0; row < kReposeBlock; ++row) {
    const auto cells = static_cast<size_t>(row * kReposeBlock);
    for (int32_t k = 0; k < kForwardLinks; ++k) {
      std::array<float, kReposeBlock> linked;
      spread_bit(tile.forward.data() + cells, kReposeBlock, static_cast<uint8_t>(1 << k),
                 linked.data());
      set_up_row(bare, TileWindow::at(0, row), TileWindow::step(k), linked.data(), limits,
                 tile.limit[static_cast<size_t>(k)].data() + cells);
    }
  }
}

}  // namespace snowbough::snow
