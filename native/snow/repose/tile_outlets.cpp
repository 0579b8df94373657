// How high snow can lie over the outlets of a surface: its rims and walls.
#include <algorithm>
#include <cmath>

#include "base/simd.h"
#include "shaders/lib/texel_repose.h"
#include "snow/repose/tile.h"
#include "snow/repose/window.h"

namespace snowbough::snow {
namespace {

struct alignas(64) Bounds {
  TileWindow::Plane bound, top, z, passed;
};

/// What cells pass on to their neighbours; returns whether any does.
SNOWBOUGH_WIDE bool pass_row(const float* __restrict bound, const float* __restrict top,
                             const float* __restrict z, float* __restrict passed) {
  int32_t any = 0;
  for (int32_t i = 0; i < kReposeBlock + 2; ++i) {
    passed[i] = shared::passed_bound(bound[i], top[i], z[i]);
    any |= passed[i] < shared::kUnbounded ? 1 : 0;
  }
  return any != 0;
}

/// Lowers the bounds of a row of cells to what others `passed` over links of those limits; returns
/// whether any changed.
SNOWBOUGH_WIDE bool lower_row(const float* __restrict passed, const float* __restrict limit,
                              float* __restrict bound) {
  int32_t changes = 0;
  for (int32_t i = 0; i < kReposeBlock; ++i) {
    const float over = passed[i] + shared::kCuts * limit[i];
    changes |= over < bound[i] ? 1 : 0;
    bound[i] = over < bound[i] ? over : bound[i];
  }
  return changes != 0;
}

class BoundSweep {
 public:
  BoundSweep(Bounds& bounds, const ReposeTile& tile) : bounds_(bounds), tile_(tile) {}

  /// Once up and once down; returns whether bounds changed.
  bool run() {
    bool changes = false;
    for (int32_t row = 0; row < kReposeBlock; ++row) changes |= within(row) | upwards(row);
    for (int32_t row = kReposeBlock - 1; row >= 0; --row) changes |= downwards(row) | within(row);
    return changes;
  }

 private:
  const float* limit(int32_t k, int32_t row) const {
    return tile_.limit[static_cast<size_t>(k)].data() + static_cast<size_t>(row * kReposeBlock);
  }
  bool pass(int32_t row) {
    const size_t at = TileWindow::at(-1, row);
    return pass_row(&bounds_.bound[at], &bounds_.top[at], &bounds_.z[at], &bounds_.passed[at]);
  }
  /// To the right and to the left, as far as it goes: mostly nowhere.
  bool within(int32_t row) {
    bool changes = false;
    while (pass(row)) {
      const size_t at = TileWindow::at(0, row);
      bool goes_on = lower_row(&bounds_.passed[at], limit(0, row), &bounds_.bound[at + 1]);
      goes_on |= lower_row(&bounds_.passed[at + 1], limit(0, row), &bounds_.bound[at]);
      if (!goes_on) break;
      changes = true;
    }
    return changes;
  }
  bool upwards(int32_t row) {
    if (!pass(row)) return false;
    bool changes = false;
    for (int32_t k = 1; k < kForwardLinks; ++k) {
      changes |= lower_row(&bounds_.passed[TileWindow::at(0, row)], limit(k, row),
                           &bounds_.bound[TileWindow::at(kForwardColumn[k], row + 1)]);
    }
    return changes;
  }
  bool downwards(int32_t row) {
    if (!pass(row + 1)) return false;
    bool changes = false;
    for (int32_t k = 1; k < kForwardLinks; ++k) {
      changes |= lower_row(&bounds_.passed[TileWindow::at(kForwardColumn[k], row + 1)],
                           limit(k, row), &bounds_.bound[TileWindow::at(0, row)]);
    }
    return changes;
  }

  Bounds& bounds_;
  const ReposeTile& tile_;
};

}  // namespace

TileBounds lower_tile_bounds(const ReposeTiles& tiles, int32_t block, int32_t blocks_a_side,
                             const std::vector<RimLink>& rims) {
  Bounds bounds;
  bounds.bound.fill(shared::kUnbounded);
  bounds.top.fill(0.0f);
  bounds.z.fill(0.0f);
  bounds.passed.fill(shared::kUnbounded);
  TileWindow::for_runs(tiles, blocks_a_side, block,
                       [&](const ReposeTile& tile, size_t cell, size_t at, size_t count) {
                         TileWindow::copy_run(tile.bound, cell, count, bounds.bound, at);
                         TileWindow::copy_run(tile.top, cell, count, bounds.top, at);
                         TileWindow::copy_run(tile.z, cell, count, bounds.z, at);
                       });
  for (const RimLink& rim : rims) {
    float& bound = bounds.bound[TileWindow::at(rim.cell % kReposeBlock, rim.cell / kReposeBlock)];
    bound = std::min(bound, rim.top + shared::kCuts * rim.limit);
  }
  BoundSweep sweep(bounds, *tiles[static_cast<size_t>(block)]);
  bool may_have_changed = !rims.empty();
  while (sweep.run()) may_have_changed = true;
  TileBounds result;
  if (!may_have_changed) return result;
  TileWindow::for_cells(tiles, blocks_a_side, block, [&](ReposeTile& part, size_t cell, size_t at) {
    if (!(bounds.bound[at] < part.bound[cell])) return;
    part.bound[cell] = bounds.bound[at];
    result.has_changed = true;
    result.border_has_changed |= TileWindow::is_border(at);
  });
  return result;
}

bool ReposeTile::cut() {
  bool cuts = false;
  for (size_t cell = 0; cell < static_cast<size_t>(kTileCells); ++cell) {
    if (!(bound[cell] < top[cell]) || !(gives[cell] > 0.0f)) continue;
    const float over = (top[cell] - std::max(bound[cell], z[cell])) / lift[cell];
    const float units = std::floor(std::min(over, gives[cell]));
    if (!(units > 0.0f)) continue;
    moved[cell] -= static_cast<double>(units);
    raise(cell);
    cuts = true;
  }
  return cuts;
}

}  // namespace snowbough::snow
