// How high snow can lie over the outlets of a surface: its rims and walls.
#include <algorithm>
#include <bit>
#include <cmath>

#include "base/simd.h"
#include "shaders/lib/texel_repose.h"
#include "snow/repose/tile.h"
#include "snow/repose/window.h"

#if defined(__GNUC__)
#define SNOWBOUGH_SWEEP SNOWBOUGH_WIDE __attribute__((flatten))
#else
#define SNOWBOUGH_SWEEP SNOWBOUGH_WIDE
#endif

namespace snowbough::snow {
namespace {

/// What cells pass on to their neighbours; returns whether any does.
inline bool pass_row(const float* __restrict bound, const float* __restrict top,
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
inline bool lower_row(const float* __restrict passed, const float* __restrict limit,
                      float* __restrict bound) {
  int32_t changes = 0;
  for (int32_t i = 0; i < kReposeBlock; ++i) {
    const float over = passed[i] + shared::kCuts * limit[i];
    changes |= over < bound[i] ? 1 : 0;
    bound[i] = over < bound[i] ? over : bound[i];
  }
  return changes != 0;
}

/// Whether any cell of a row has a bound.
inline bool is_bounded(const float* bound) {
  int32_t any = 0;
  for (int32_t i = 0; i < kReposeBlock + 2; ++i) any |= bound[i] < shared::kUnbounded ? 1 : 0;
  return any != 0;
}

constexpr uint64_t bit(int32_t row) {
  return uint64_t{1} << static_cast<uint32_t>(row);
}

/// Lowers the bounds of a block's window row by row, as long as any passes on what it did not
/// before. Only those rows of the window are there that anything asks for.
class BoundSweep {
 public:
  explicit BoundSweep(const TilesAround& around) : around_(around), tile_(*around.at(0, 0)) {}

  TileBounds run(const std::vector<RimLink>& rims) {
    for (const RimLink& rim : rims) {
      const int32_t row = rim.cell / kReposeBlock;
      lower(row, rim.cell % kReposeBlock, rim.top + shared::kCuts * rim.limit);
    }
    sweep(rows_to_pass());
    return write();
  }

 private:
  /// Rows of the window that have bounds and have not passed them on.
  uint64_t rows_to_pass() {
    uint64_t rows = tile_.rows_to_pass.exchange(0, std::memory_order_relaxed) | changed_;
    for (int32_t row = 0; row < TileWindow::kRows; ++row) {
      if ((rows & bit(row)) == 0) continue;
      load_bound(row);
      if (!is_bounded(&bound_[TileWindow::at(-1, row)])) rows &= ~bit(row);
    }
    return rows;
  }

  /// Up and down in turns until nothing changes.
  void sweep(uint64_t rows) {
    while (rows != 0) {
      fresh_ = 0;
      for (int32_t row = 0; row < TileWindow::kRows; ++row) {
        if (((rows | fresh_) & bit(row)) != 0) pass_on(row);
      }
      rows = fresh_;
      fresh_ = 0;
      for (int32_t row = TileWindow::kRows - 1; row >= 0; --row) {
        if (((rows | fresh_) & bit(row)) != 0) pass_on(row);
      }
      rows = fresh_;
    }
  }

  /// Writes what changed to the tiles.
  TileBounds write() {
    TileBounds result;
    for (int32_t row = 0; row < TileWindow::kRows; ++row) {
      if ((changed_ & bit(row)) == 0) continue;
      load(row);
      TileWindow::for_row(
          around_, row, [&](ReposeTile* tile, size_t cell, int32_t column, size_t count) {
            const size_t at = TileWindow::at(column, row);
            for (size_t i = 0; tile != nullptr && i < count; ++i) {
              if (!(bound_[at + i] < tile->bound[cell + i])) continue;
              tile->bound[cell + i] = bound_[at + i];
              tile->has_bounds.store(true, std::memory_order_relaxed);
              const float passed = shared::passed_bound(bound_[at + i], top_[at + i], z_[at + i]);
              if (!(passed < shared::kUnbounded)) continue;
              tile->has_fresh_bounds.store(true, std::memory_order_relaxed);
              result.has_changed = true;
              const int32_t own = column + static_cast<int32_t>(i);
              if (!TileWindow::is_border(own, row)) continue;
              result.seen_by |= TileWindow::seen_by(own, row);
              note_bound(around_, own, row);
            }
          });
    }
    // The tile's own have passed on all that they can.
    tile_.rows_to_pass.store(0, std::memory_order_relaxed);
    return result;
  }

  void load_bound(int32_t row) {
    if ((bounds_ & bit(row)) != 0) return;
    bounds_ |= bit(row);
    TileWindow::copy_row(around_, row, &ReposeTile::bound, bound_, shared::kUnbounded);
  }
  void load(int32_t row) {
    load_bound(row);
    if ((loaded_ & bit(row)) != 0) return;
    loaded_ |= bit(row);
    TileWindow::copy_row(around_, row, &ReposeTile::top, top_, 0.0f);
    TileWindow::copy_row(around_, row, &ReposeTile::z, z_, 0.0f);
  }
  const float* limit(int32_t k, int32_t row) const {
    return tile_.limit[static_cast<size_t>(k)].data() + static_cast<size_t>(row * kReposeBlock);
  }
  void lower(int32_t row, int32_t column, float bound) {
    load_bound(row);
    float& own = bound_[TileWindow::at(column, row)];
    if (!(bound < own)) return;
    own = bound;
    changed_ |= bit(row);
  }
  bool pass(int32_t row) {
    load(row);
    const size_t at = TileWindow::at(-1, row);
    return pass_row(&bound_[at], &top_[at], &z_[at], &passed_[at]);
  }
  /// To the right and to the left, as far as it goes: mostly nowhere. Returns whether the row
  /// passes anything on.
  bool within(int32_t row) {
    while (pass(row)) {
      if (row == kReposeBlock) return true;
      const size_t at = TileWindow::at(0, row);
      bool goes_on = lower_row(&passed_[at], limit(0, row), &bound_[at + 1]);
      goes_on |= lower_row(&passed_[at + 1], limit(0, row), &bound_[at]);
      if (!goes_on) return true;
      changed_ |= bit(row);
    }
    return false;
  }
  /// All that a row passes on, to itself and to the rows beside it.
  void pass_on(int32_t row) {
    const bool passes = within(row);
    fresh_ &= ~bit(row);
    if (!passes) return;
    const float* const passed = &passed_[TileWindow::at(0, row)];
    bool up = false;
    bool down = false;
    if (row < kReposeBlock) {
      load_bound(row + 1);
      for (int32_t k = 1; k < kForwardLinks; ++k) {
        up |= lower_row(passed, limit(k, row), &bound_[TileWindow::at(kForwardColumn[k], row + 1)]);
      }
    }
    if (row > 0) {
      load_bound(row - 1);
      for (int32_t k = 1; k < kForwardLinks; ++k) {
        down |= lower_row(passed + kForwardColumn[k], limit(k, row - 1),
                          &bound_[TileWindow::at(0, row - 1)]);
      }
    }
    const uint64_t lowered = (up ? bit(row + 1) : 0) | (down ? bit(row - 1) : 0);
    fresh_ |= lowered;
    changed_ |= lowered;
  }

  const TilesAround& around_;
  ReposeTile& tile_;
  /// Rows whose bounds are lower than when they were last passed on, and than the tiles'; of which
  /// bounds, and all planes, are there.
  uint64_t fresh_ = 0, changed_ = 0, bounds_ = 0, loaded_ = 0;
  alignas(64) TileWindow::Plane bound_;
  TileWindow::Plane top_, z_, passed_;
};

SNOWBOUGH_SWEEP TileBounds sweep_bounds(const TilesAround& around,
                                        const std::vector<RimLink>& rims) {
  return BoundSweep(around).run(rims);
}

/// Whether any cell of a block's window has a bound.
bool has_bounds(const TilesAround& around) {
  for (int32_t dy = 0; dy <= 1; ++dy) {
    for (int32_t dx = -1; dx <= 1; ++dx) {
      const ReposeTile* const tile = around.at(dx, dy);
      if (tile != nullptr && tile->has_bounds.load(std::memory_order_relaxed)) return true;
    }
  }
  return false;
}

}  // namespace

void note_bound(const TilesAround& around, int32_t column, int32_t row) {
  for (int32_t dy = -1; dy <= 1; ++dy) {
    for (int32_t dx = -1; dx <= 1; ++dx) {
      const int32_t x = column - dx * kReposeBlock;
      const int32_t y = row - dy * kReposeBlock;
      ReposeTile* const tile = around.at(dx, dy);
      if (tile == nullptr || !TileWindow::has(x, y)) continue;
      if ((tile->rows_to_pass.load(std::memory_order_relaxed) & bit(y)) != 0) continue;
      tile->rows_to_pass.fetch_or(bit(y), std::memory_order_relaxed);
    }
  }
}

TileBounds lower_tile_bounds(const ReposeTiles& tiles, int32_t block, int32_t blocks_a_side,
                             const std::vector<RimLink>& rims) {
  const TilesAround around(tiles, blocks_a_side, block);
  if (rims.empty() && !has_bounds(around)) return {};
  return sweep_bounds(around, rims);
}

}  // namespace snowbough::snow
