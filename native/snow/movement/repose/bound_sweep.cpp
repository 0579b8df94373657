// Bounds on snow above the outlets of a surface, its rims and walls: lower_tile_bounds.
#include <algorithm>
#include <cmath>
#include <utility>

#include "base/simd.h"
#include "shaders/lib/texel_repose.h"
#include "snow/movement/repose/tiles_around.h"

#define SNOWBOUGH_SWEEP SNOWBOUGH_WIDE_FLAT

namespace snowbough::snow {
namespace {

/// Computes the bounds that cells pass on; returns whether there are any.
inline bool pass_row(const float* __restrict bound, const float* __restrict top,
                     const float* __restrict z, float* __restrict passed) {
  int32_t any = 0;
  for (int32_t i = 0; i < kReposeBlock + 2; ++i) {
    passed[i] = shared::passed_bound(bound[i], top[i], z[i]);
    any |= passed[i] < shared::kUnbounded ? 1 : 0;
  }
  return any != 0;
}

/// Lowers the bounds of a row to the neighbours' `passed` plus the links' limits, but not below the
/// bare surface; returns whether any changed.
inline bool lower_row(const float* __restrict passed, const float* __restrict limit,
                      const float* __restrict z, float* __restrict bound) {
  int32_t changes = 0;
  for (int32_t i = 0; i < kReposeBlock; ++i) {
    const float over = std::max(passed[i] + shared::kCuts * limit[i], z[i]);
    changes |= over < bound[i] ? 1 : 0;
    bound[i] = over < bound[i] ? over : bound[i];
  }
  return changes != 0;
}

/// A row of quads seen from two of their corners, opposite the side from A to B: the side's length,
/// its distance from the corners, and A's offset along it from the foot of the first corner (the
/// other's is smaller by a length). In metres of bound; all 0: no quad.
struct Sides {
  std::array<float, kReposeBlock> length, away, place;
};

/// Measures a row's quads, each from a cell and its neighbours to the right, above, and above
/// right: the vertical and horizontal sides. The limits of a quad's links are the lengths of its
/// sides and diagonal.
inline void measure_row(const float* __restrict right, const float* __restrict above,
                        const float* __restrict diagonal, Sides& up, Sides& along) {
  // Fraction of the sides' product below which a quad is degenerate, seen from above.
  constexpr float kFlat = 1e-4f;
  for (int32_t i = 0; i < kReposeBlock; ++i) {
    const float a = shared::kCuts * right[i];
    const float b = shared::kCuts * above[i];
    const float c = shared::kCuts * diagonal[i];
    const float mixed = 0.5f * (c * c - a * a - b * b);
    const float square = a * a * b * b - mixed * mixed;
    // Also false without a link.
    const bool is_there = square > kFlat * a * a * b * b;
    const float size = std::sqrt(is_there ? square : 0.0f);
    along.length[i] = is_there ? a : 0.0f;
    up.length[i] = is_there ? b : 0.0f;
    along.away[i] = is_there ? size / a : 0.0f;
    up.away[i] = is_there ? size / b : 0.0f;
    along.place[i] = is_there ? mixed / a : 0.0f;
    up.place[i] = is_there ? mixed / b : 0.0f;
  }
}

/// Lowers the bounds of the first or second of a row of quads' corners by paths across the side
/// from `a` to `b`, along which bounds are linear: along the path with the smallest rise, if it
/// crosses the side (Hopf and Lax's formula on a triangle: F. Bornemann and C. Rasch,
/// Finite-element discretization of static Hamilton-Jacobi equations based on a local variational
/// principle, 2006). `sign`: -1 for the side on the other side of the quads. Returns whether any
/// changed, for either corner.
inline std::pair<bool, bool> lower_over_sides(const float* __restrict a, const float* __restrict b,
                                              const Sides& sides, float sign, const float* z,
                                              float* bound, size_t first, size_t second) {
  // Fraction of a bound's rise per texel below which a change is not passed on.
  constexpr float kLeastChange = 4e-3f;
  const float* __restrict const length = sides.length.data();
  const float* __restrict const away = sides.away.data();
  const float* __restrict const places = sides.place.data();
  // No path across a side is shorter than the perpendicular.
  int32_t may_lower = 0;
  for (int32_t i = 0; i < kReposeBlock; ++i) {
    const auto own = static_cast<size_t>(i);
    const float highest = std::max(bound[first + own], bound[second + own]);
    const float least = std::min(a[i], b[i]) + (1.0f + kLeastChange) * away[i];
    may_lower |= ((std::abs(b[i] - a[i]) < length[i]) & (least < highest)) ? 1 : 0;
  }
  if (may_lower == 0) return {false, false};
  std::array<float, kReposeBlock> over_first;
  std::array<float, kReposeBlock> over_second;
  for (int32_t i = 0; i < kReposeBlock; ++i) {
    const float rise = b[i] - a[i];
    const bool is_open = std::abs(rise) < length[i];
    const float part = is_open ? rise / length[i] : 0.0f;
    const float flat = std::sqrt(1.0f - part * part);
    const float place = sign * places[i];
    const float foot = -part * away[i];
    const float over = a[i] + (away[i] * flat - part * place);
    const bool is_first = is_open & (foot >= place * flat) & (foot <= (place + length[i]) * flat);
    const bool is_second = is_open & (foot >= (place - length[i]) * flat) & (foot < place * flat);
    over_first[i] = is_first ? over : shared::kUnbounded;
    over_second[i] = is_second ? over + rise : shared::kUnbounded;
  }
  const auto lower = [&](const std::array<float, kReposeBlock>& over, const float* __restrict bare,
                         float* __restrict own) {
    int32_t changes = 0;
    for (int32_t i = 0; i < kReposeBlock; ++i) {
      const float now = std::max(over[i], bare[i]);
      const bool lowers = now < own[i] - kLeastChange * away[i];
      changes |= lowers ? 1 : 0;
      own[i] = lowers ? now : own[i];
    }
    return changes != 0;
  };
  const bool lowers_first = lower(over_first, z + first, bound + first);
  return {lowers_first, lower(over_second, z + second, bound + second)};
}

/// Whether any passed bound may lower those of a row of quads' corners, in the rows `low` and
/// `high`.
inline bool may_lower_bounds(const float* __restrict diagonal, const float* __restrict passed,
                             const float* __restrict bound, const float* __restrict z, size_t low,
                             size_t high) {
  int32_t any = 0;
  for (size_t i = 0; i < static_cast<size_t>(kReposeBlock); ++i) {
    const bool is_high = (bound[low + i] > z[low + i]) | (bound[low + i + 1] > z[low + i + 1]) |
                         (bound[high + i] > z[high + i]) | (bound[high + i + 1] > z[high + i + 1]);
    const float least = std::min(std::min(passed[low + i], passed[low + i + 1]),
                                 std::min(passed[high + i], passed[high + i + 1]));
    any |= ((diagonal[i] < shared::kUnbounded) & is_high & (least < shared::kUnbounded)) ? 1 : 0;
  }
  return any != 0;
}

/// Whether any cell of a row has a bound.
inline bool is_bounded(const float* bound) {
  int32_t any = 0;
  for (int32_t i = 0; i < kReposeBlock + 2; ++i) any |= bound[i] < shared::kUnbounded ? 1 : 0;
  return any != 0;
}

/// Lowers the bounds of a block's window row by row, as long as any row has new bounds to pass on.
/// Rows of the window are loaded on demand.
class BoundSweep {
 public:
  explicit BoundSweep(const TilesAround& around)
      : around_(around), links_(around.at(0, 0)->links), outlets_(around.at(0, 0)->outlets) {}

  TileBounds run(const std::vector<RimLink>& rims) {
    for (const RimLink& rim : rims) {
      const int32_t row = rim.cell / kReposeBlock;
      lower(row, rim.cell % kReposeBlock, rim.top + shared::kCuts * rim.limit);
    }
    sweep(rows_to_pass());
    return write();
  }

 private:
  /// Rows of the window with bounds that have not been passed on.
  uint64_t rows_to_pass() {
    uint64_t rows = outlets_.rows_to_pass.exchange(0, std::memory_order_relaxed) | changed_;
    for (int32_t row = 0; row < TileWindow::kRows; ++row) {
      if ((rows & row_bit(row)) == 0) continue;
      load_bound(row);
      if (!is_bounded(&bound_[TileWindow::at(-1, row)])) rows &= ~row_bit(row);
    }
    return rows;
  }

  /// Over links, alternately up and down until nothing changes; then over quads, and so on.
  void sweep(uint64_t rows) {
    while ((rows | quads_) != 0) {
      fresh_ = 0;
      for (int32_t row = 0; row < TileWindow::kRows; ++row) {
        if (((rows | fresh_) & row_bit(row)) != 0) pass_on(row);
      }
      rows = fresh_;
      fresh_ = 0;
      for (int32_t row = TileWindow::kRows - 1; row >= 0; --row) {
        if (((rows | fresh_) & row_bit(row)) != 0) pass_on(row);
      }
      rows = fresh_;
      for (int32_t row = 0; rows == 0 && row < kReposeBlock; ++row) pass_over_quads(row);
      rows |= fresh_;
    }
  }

  /// Writes the changes to the tiles.
  TileBounds write() {
    TileBounds result;
    for (int32_t row = 0; row < TileWindow::kRows; ++row) {
      if ((changed_ & row_bit(row)) == 0) continue;
      load(row);
      around_.for_row(row, [&](ReposeTile* tile, size_t cell, int32_t column, size_t count) {
        const size_t at = TileWindow::at(column, row);
        for (size_t i = 0; tile != nullptr && i < count; ++i) {
          if (!(bound_[at + i] < tile->outlets.bound[cell + i])) continue;
          tile->outlets.bound[cell + i] = bound_[at + i];
          tile->outlets.has_bounds.store(true, std::memory_order_relaxed);
          const float passed = shared::passed_bound(bound_[at + i], top_[at + i], z_[at + i]);
          if (!(passed < shared::kUnbounded)) continue;
          tile->outlets.has_fresh_bounds.store(true, std::memory_order_relaxed);
          result.has_changed = true;
          const int32_t own = column + static_cast<int32_t>(i);
          if (!TileWindow::is_border(own, row)) continue;
          result.seen_by |= TileWindow::seen_by(own, row);
          note_bound(around_, own, row);
        }
      });
    }
    // The tile's own rows have passed on everything.
    outlets_.rows_to_pass.store(0, std::memory_order_relaxed);
    return result;
  }

  void load_bound(int32_t row) {
    if ((bounds_ & row_bit(row)) != 0) return;
    bounds_ |= row_bit(row);
    around_.copy_row(row, &ReposeTile::outlets, &TileOutlets::bound, bound_, shared::kUnbounded);
  }
  void load(int32_t row) {
    load_bound(row);
    if ((loaded_ & row_bit(row)) != 0) return;
    loaded_ |= row_bit(row);
    around_.copy_row(row, &ReposeTile::snow, &TileSnow::top, top_, 0.0f);
    around_.copy_row(row, &ReposeTile::ground, &TileGround::z, z_, 0.0f);
  }
  const float* limit(int32_t k, int32_t row) const {
    return links_.limit[static_cast<size_t>(k)].data() + static_cast<size_t>(row * kReposeBlock);
  }
  void lower(int32_t row, int32_t column, float bound) {
    load_bound(row);
    float& own = bound_[TileWindow::at(column, row)];
    if (!(bound < own)) return;
    own = bound;
    changed_ |= row_bit(row);
  }
  bool pass(int32_t row) {
    load(row);
    const size_t at = TileWindow::at(-1, row);
    return pass_row(&bound_[at], &top_[at], &z_[at], &passed_[at]);
  }
  /// To the right and to the left as far as bounds change, usually not at all. Returns whether the
  /// row passes anything on.
  bool within(int32_t row) {
    if (!pass(row)) return false;
    if (row == kReposeBlock) return true;
    const size_t at = TileWindow::at(0, row);
    bool changed = lower_row(&passed_[at], limit(0, row), &z_[at + 1], &bound_[at + 1]);
    changed |= lower_row(&passed_[at + 1], limit(0, row), &z_[at], &bound_[at]);
    if (!changed) return true;
    changed_ |= row_bit(row);
    // What comes from the left does not change by what it passes on to the left, nor the other way.
    const float* const limits = limit(0, row);
    const auto pass_to = [&](size_t from, size_t to, float limit) {
      const float passed = shared::passed_bound(bound_[from], top_[from], z_[from]);
      const float over = std::max(passed + shared::kCuts * limit, z_[to]);
      if (over < bound_[to]) bound_[to] = over;
    };
    constexpr size_t kCells = kReposeBlock;
    for (size_t i = 0; i < kCells; ++i) pass_to(at + i, at + i + 1, limits[i]);
    for (size_t i = kCells; i > 0; --i) pass_to(at + i, at + i - 1, limits[i - 1]);
    return pass(row);
  }
  void measure(int32_t row) {
    if ((measured_ & row_bit(row)) != 0) return;
    measured_ |= row_bit(row);
    measure_row(limit(0, row), limit(1, row), limit(2, row), up_[static_cast<size_t>(row)],
                along_[static_cast<size_t>(row)]);
  }
  /// Passes bounds over the sides of a row of quads, if its corners have new ones.
  void pass_over_quads(int32_t row) {
    if (row < 0 || row >= kReposeBlock || (quads_ & row_bit(row)) == 0) return;
    quads_ &= ~row_bit(row);
    const bool passes = pass(row);
    if (!pass(row + 1) && !passes) return;
    if (!may_lower_bounds(limit(2, row), passed_.data(), bound_.data(), z_.data(),
                          TileWindow::at(0, row), TileWindow::at(0, row + 1))) {
      return;
    }
    measure(row);
    const Sides& up = up_[static_cast<size_t>(row)];
    const Sides& along = along_[static_cast<size_t>(row)];
    const size_t low = TileWindow::at(0, row);
    const size_t high = TileWindow::at(0, row + 1);
    const float* const p = passed_.data();
    const auto over = [&](size_t a, size_t b, const Sides& sides, float sign, size_t first,
                          size_t second) {
      return lower_over_sides(p + a, p + b, sides, sign, z_.data(), bound_.data(), first, second);
    };
    const auto right = over(low + 1, high + 1, up, 1.0f, low, high);
    const auto left = over(low, high, up, -1.0f, low + 1, high + 1);
    const auto top = over(high, high + 1, along, 1.0f, low, low + 1);
    const auto base = over(low, low + 1, along, -1.0f, high, high + 1);
    const bool lowers_low = right.first | left.first | top.first | top.second;
    const bool lowers_high = right.second | left.second | base.first | base.second;
    const uint64_t lowered = (lowers_low ? row_bit(row) : 0) | (lowers_high ? row_bit(row + 1) : 0);
    fresh_ |= lowered;
    changed_ |= lowered;
  }
  /// Passes on everything from a row to itself and to the adjacent rows.
  void pass_on(int32_t row) {
    const bool passes = within(row);
    fresh_ &= ~row_bit(row);
    if (!passes) return;
    quads_ |= (row_bit(row) | row_bit(row) >> 1) & kAllRows;
    const float* const passed = &passed_[TileWindow::at(0, row)];
    bool up = false;
    bool down = false;
    if (row < kReposeBlock) {
      load(row + 1);
      for (int32_t k = 1; k < kForwardLinks; ++k) {
        const size_t at = TileWindow::at(kForwardColumn[k], row + 1);
        up |= lower_row(passed, limit(k, row), &z_[at], &bound_[at]);
      }
    }
    if (row > 0) {
      load(row - 1);
      for (int32_t k = 1; k < kForwardLinks; ++k) {
        const size_t at = TileWindow::at(0, row - 1);
        down |= lower_row(passed + kForwardColumn[k], limit(k, row - 1), &z_[at], &bound_[at]);
      }
    }
    const uint64_t lowered = (up ? row_bit(row + 1) : 0) | (down ? row_bit(row - 1) : 0);
    fresh_ |= lowered;
    changed_ |= lowered;
  }

  const TilesAround& around_;
  const TileLinks& links_;
  TileOutlets& outlets_;
  /// Rows whose bounds were lowered since they were last passed on over links, over quads, and
  /// since they were written to the tiles; and rows whose bounds, all planes, and quads are loaded.
  uint64_t fresh_ = 0, quads_ = 0, changed_ = 0, bounds_ = 0, loaded_ = 0, measured_ = 0;
  std::array<Sides, kReposeBlock> up_, along_;
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
      if (tile != nullptr && tile->outlets.has_bounds.load(std::memory_order_relaxed)) return true;
    }
  }
  return false;
}

}  // namespace

TileBounds lower_tile_bounds(const ReposeTiles& tiles, int32_t block, int32_t blocks_a_side,
                             const std::vector<RimLink>& rims) {
  const TilesAround around(tiles, blocks_a_side, block);
  if (rims.empty() && !has_bounds(around)) return {};
  return sweep_bounds(around, rims);
}

}  // namespace snowbough::snow
