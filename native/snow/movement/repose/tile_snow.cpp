#include "snow/movement/repose/tile_snow.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/simd.h"
#include "shaders/lib/texel_repose.h"

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

SNOWBOUGH_WIDE_FLAT bool hold_rows(const TileGround& ground, const float* height, size_t pitch,
                                   glm::ivec2 size, float units, TileSnow& snow) {
  bool is_below = false;
  for (int32_t row = 0; row < size.y; ++row) {
    const auto first = static_cast<size_t>(row * kReposeBlock);
    is_below |= hold_row(height + static_cast<size_t>(row) * pitch, size.x, &ground.area[first],
                         units, &ground.z[first], &snow.lift[first], &snow.held[first],
                         &snow.top[first], &snow.gives[first]);
  }
  return is_below;
}

}  // namespace

void TileSnow::begin_pose() {
  held = top = lift = gives = {};
  moved.fill(0.0);
  kind.fill(kUnknown);
  any_back = any_full = false;
}

void TileSnow::begin_step(bool bare) {
  is_bare = bare;
  // Only rows that were written: tiles have many planes and mostly rest.
  for (uint32_t rows = moved_rows; rows != 0; rows &= rows - 1) {
    std::fill_n(moved.begin() + std::countr_zero(rows) * kReposeBlock, kReposeBlock, 0.0);
  }
  moved_rows = 0;
}

bool TileSnow::cover(const TileGround& ground, size_t cell, float height, float unit) {
  const float side = shared::snow_side(height, ground.up[cell], ground.two_sided[cell] != 0);
  const bool wall = shared::is_wall(side * ground.up[cell]) || ground.area[cell] <= 0.0f;
  const auto now =
      static_cast<uint8_t>((wall ? kWall : 0) | (side < 0.0f ? kBack : 0) | (kind[cell] & kFull));
  const bool changes = now != kind[cell];
  if (changes) {
    kind[cell] = now;
    any_back = any_back || side < 0.0f;
    const float rise = shared::column_height(side * ground.normal_z[cell]);
    lift[cell] = wall ? 0.0f : rise * (unit / ground.area[cell]);
  }
  held[cell] = std::abs(height) * (ground.area[cell] / unit);
  top[cell] = ground.z[cell] + lift[cell] * held[cell];
  gives[cell] = lift[cell] > 0.0f ? held[cell] : 0.0f;
  return changes;
}

bool TileSnow::cover_rows(const TileGround& ground, const float* height, size_t pitch,
                          glm::ivec2 size, float unit) {
  return hold_rows(ground, height, pitch, size, 1.0f / unit, *this);
}

}  // namespace snowbough::snow
