#include "snow/movement/repose/tile.h"

#include <algorithm>
#include <cmath>

#include "base/simd.h"

namespace snowbough::snow {
namespace {

/// Whether any of a row's snow exceeds its bounds.
SNOWBOUGH_WIDE bool is_any_over(const float* __restrict bound, const float* __restrict top) {
  int32_t over = 0;
  for (int32_t i = 0; i < kReposeBlock; ++i) over |= bound[i] < top[i] ? 1 : 0;
  return over != 0;
}

}  // namespace

void ReposeTile::begin_pose() {
  ground.begin_pose();
  snow.begin_pose();
  outlets.begin_pose();
  links.has_limits = false;
}

bool ReposeTile::cover(size_t cell, float height, float unit) {
  const bool changes = snow.cover(ground, cell, height, unit);
  if (changes) outlets.any_wall = outlets.any_wall || snow.is_wall(cell);
  return changes;
}

bool ReposeTile::cover_rows(const float* height, size_t pitch, glm::ivec2 size, float unit) {
  const bool is_below = snow.cover_rows(ground, height, pitch, size, unit);
  if (!(ground.any_two_sided || snow.any_back || is_below)) return false;
  bool changes = false;
  for (int32_t row = 0; row < size.y; ++row) {
    const float* const own = height + static_cast<size_t>(row) * pitch;
    const auto first = static_cast<size_t>(row * kReposeBlock);
    for (size_t i = 0; i < static_cast<size_t>(size.x); ++i) {
      if (snow.kind[first + i] != kUnknown) changes |= cover(first + i, own[i], unit);
    }
  }
  return changes;
}

void ReposeTile::begin_step(bool bare) {
  links.begin_step(snow.has_moved());
  snow.begin_step(bare);
  outlets.begin_step();
}

bool ReposeTile::cut() {
  if (!outlets.has_bounds || snow.is_bare) return false;
  const TilePlane& bound = outlets.bound;
  bool cuts = false;
  for (size_t cell = 0; cell < static_cast<size_t>(kTileCells); ++cell) {
    if (cell % kReposeBlock == 0 && !is_any_over(bound.data() + cell, snow.top.data() + cell)) {
      cell += kReposeBlock - 1;
      continue;
    }
    if (!(bound[cell] < snow.top[cell])) continue;
    if (!(snow.gives[cell] > 0.0f)) continue;
    const float over = (snow.top[cell] - std::max(bound[cell], ground.z[cell])) / snow.lift[cell];
    // A sliver of a texel may hold less than a unit.
    const float most = std::min(over, snow.gives[cell]);
    const float units = snow.gives[cell] < 1.0f ? most : std::floor(most);
    if (!(units > 0.0f)) continue;
    add(cell, -static_cast<double>(units));
    outlets.cuts.emplace_back(static_cast<int32_t>(cell), units);
    cuts = true;
  }
  return cuts;
}

}  // namespace snowbough::snow
