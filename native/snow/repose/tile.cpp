#include "snow/repose/tile.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/simd.h"
#include "shaders/lib/texel_repose.h"
#include "snow/repose/tiles_around.h"

#define SNOWBOUGH_TILE SNOWBOUGH_WIDE_FLAT

namespace snowbough::snow {
namespace {

/// Sets the snow of cells whose kinds stay; returns whether any lies on the back.
inline bool hold_row(const float* __restrict height, int32_t count, const float* __restrict area,
                     float units, const float* __restrict z, const float* __restrict lift,
                     float* __restrict held, float* __restrict top, float* __restrict gives) {
  int32_t below = 0;
  for (int32_t i = 0; i < count; ++i) {
    below |= height[i] < 0.0f ? 1 : 0;
    held[i] = std::abs(height[i]) * (area[i] * units);
    top[i] = z[i] + lift[i] * held[i];
    gives[i] = lift[i] > 0.0f ? held[i] : 0.0f;
  }
  return below != 0;
}

/// The same for rows of a tile.
SNOWBOUGH_TILE bool hold_rows(const float* height, size_t pitch, glm::ivec2 size, float units,
                              ReposeTile& tile) {
  bool is_below = false;
  for (int32_t row = 0; row < size.y; ++row) {
    const auto first = static_cast<size_t>(row * kReposeBlock);
    is_below |= hold_row(height + static_cast<size_t>(row) * pitch, size.x, &tile.area[first],
                         units, &tile.z[first], &tile.lift[first], &tile.held[first],
                         &tile.top[first], &tile.gives[first]);
  }
  return is_below;
}

/// Sets bounds at the start of a step; returns whether there is a wall.
SNOWBOUGH_TILE bool bound_walls(ReposeTile& tile) {
  uint8_t walls = 0;
  for (size_t cell = 0; cell < static_cast<size_t>(kTileCells); ++cell) {
    walls |= tile.kind[cell] & kWall;
    const float bare = tile.z[cell];
    tile.bound[cell] = (tile.kind[cell] & kWall) != 0 ? bare : shared::kUnbounded;
  }
  return walls != 0;
}

/// Whether any of a row's snow exceeds its bounds.
SNOWBOUGH_WIDE bool is_any_over(const float* __restrict bound, const float* __restrict top) {
  int32_t over = 0;
  for (int32_t i = 0; i < kReposeBlock; ++i) over |= bound[i] < top[i] ? 1 : 0;
  return over != 0;
}

}  // namespace

void ReposeTile::begin_pose() {
  x = y = z = normal_z = up = area = curvature = lift = {};
  held = top = gives = {};
  moved.fill(0.0);
  forward.fill(0);
  two_sided.fill(0);
  links.fill(static_cast<uint8_t>(shared::kLinks));
  kind.fill(kUnknown);
  bound.fill(shared::kUnbounded);
  any_two_sided = any_back = false;
  has_pose = true;
  has_links = false;
}

void ReposeTile::begin_step(bool bare) {
  is_bare = bare;
  // Only rows that were written: tiles have many planes and mostly rest.
  for (uint32_t rows = moved_rows; rows != 0; rows &= rows - 1) {
    std::fill_n(moved.begin() + std::countr_zero(rows) * kReposeBlock, kReposeBlock, 0.0);
  }
  if (!has_moved()) flow.reset();
  for (uint32_t rows = flow != nullptr ? flow_rows : 0; rows != 0; rows &= rows - 1) {
    for (Plane& plane : *flow) {
      std::fill_n(plane.begin() + std::countr_zero(rows) * kReposeBlock, kReposeBlock, 0.0f);
    }
  }
  if (has_bounds) has_bounds = any_wall = bound_walls(*this);
  has_fresh_bounds = false;
  moved_rows = flow_rows = 0;
  flowing = partial_rows = 0;
  active_rows = active_rows_at_seams = kAllRows;
  rows_to_pass = kAllWindowRows;
}

void ReposeTile::set_kind(size_t cell, uint8_t now, float unit) {
  kind[cell] = now;
  const bool wall = (now & kWall) != 0;
  const bool back = (now & kBack) != 0;
  const float side = back ? -1.0f : 1.0f;
  any_back = any_back || back;
  lift[cell] = wall ? 0.0f : shared::column_height(side * normal_z[cell]) * (unit / area[cell]);
  // A wall is an outlet: snow above it falls.
  bound[cell] = wall ? z[cell] : shared::kUnbounded;
  if (wall) has_bounds = true;
}

bool ReposeTile::cover(size_t cell, float height, float unit) {
  const float side = shared::snow_side(height, up[cell], two_sided[cell] != 0);
  const bool wall = shared::is_wall(side * up[cell]) || area[cell] <= 0.0f;
  const auto now = static_cast<uint8_t>((wall ? kWall : 0) | (side < 0.0f ? kBack : 0));
  const bool changes = now != kind[cell];
  if (changes) set_kind(cell, now, unit);
  held[cell] = std::abs(height) * (area[cell] / unit);
  top[cell] = z[cell] + lift[cell] * held[cell];
  gives[cell] = lift[cell] > 0.0f ? held[cell] : 0.0f;
  return changes;
}

bool ReposeTile::cover_rows(const float* height, size_t pitch, glm::ivec2 size, float unit) {
  const bool is_below = hold_rows(height, pitch, size, 1.0f / unit, *this);
  if (!(any_two_sided || any_back || is_below)) return false;
  bool changes = false;
  for (int32_t row = 0; row < size.y; ++row) {
    const float* const own = height + static_cast<size_t>(row) * pitch;
    const auto first = static_cast<size_t>(row * kReposeBlock);
    for (size_t i = 0; i < static_cast<size_t>(size.x); ++i) {
      if (kind[first + i] != kUnknown) changes |= cover(first + i, own[i], unit);
    }
  }
  return changes;
}

bool ReposeTile::cut() {
  if (!has_bounds || is_bare) return false;
  bool cuts = false;
  for (size_t cell = 0; cell < static_cast<size_t>(kTileCells); ++cell) {
    if (cell % kReposeBlock == 0 && !is_any_over(bound.data() + cell, top.data() + cell)) {
      cell += kReposeBlock - 1;
      continue;
    }
    if (!(bound[cell] < top[cell])) continue;
    if (!(gives[cell] > 0.0f)) continue;
    const float over = (top[cell] - std::max(bound[cell], z[cell])) / lift[cell];
    // A sliver of a texel may hold less than a unit.
    const float most = std::min(over, gives[cell]);
    const float units = gives[cell] < 1.0f ? most : std::floor(most);
    if (!(units > 0.0f)) continue;
    add(cell, -static_cast<double>(units));
    cuts = true;
  }
  return cuts;
}

void activate_cell(const TilesAround& around, int32_t column, int32_t row) {
  const auto activate = [&](int32_t x, int32_t y) {
    const int32_t dx = x < 0 ? -1 : x / kReposeBlock;
    const int32_t dy = y < 0 ? -1 : y / kReposeBlock;
    ReposeTile* const tile = around.at(dx, dy);
    if (tile == nullptr) return;
    tile->active_rows.fetch_or(1u << static_cast<uint32_t>(y & (kReposeBlock - 1)),
                               std::memory_order_relaxed);
  };
  activate(column, row);
  activate(column - 1, row);
  for (int32_t x = column - 1; x <= column + 1; ++x) activate(x, row - 1);
}

}  // namespace snowbough::snow
