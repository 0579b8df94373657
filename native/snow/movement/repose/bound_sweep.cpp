// Bounds on snow above the outlets of a surface, its open edges and walls: lower_tile_bounds.
#include <algorithm>
#include <cmath>

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

/// A line of quads seen from two of their corners, opposite the side from A to B: the side's
/// length, its distance from the corners, and A's offset along it from the foot of the first corner
/// (the other's is smaller by a length). In metres of bound; all 0: no quad.
struct Sides {
  std::array<float, kReposeBlock> length, away, place;
};

/// Measures the sides along a line of quads, each from a cell, its neighbours along and across the
/// line, and the one diagonal to it. The limits of a quad's links are the lengths of its sides and
/// diagonal.
inline void measure_line(const float* __restrict along, const float* __restrict across,
                         const float* __restrict diagonal, Sides& sides) {
  // Fraction of the sides' product below which a quad is degenerate, seen from above.
  constexpr float kFlat = 1e-4f;
  for (int32_t i = 0; i < kReposeBlock; ++i) {
    const float a = shared::kCuts * along[i];
    const float b = shared::kCuts * across[i];
    const float c = shared::kCuts * diagonal[i];
    const float mixed = 0.5f * (c * c - a * a - b * b);
    const float square = a * a * b * b - mixed * mixed;
    // Also false without a link.
    const bool is_there = square > kFlat * a * a * b * b;
    const float size = std::sqrt(is_there ? square : 0.0f);
    sides.length[i] = is_there ? a : 0.0f;
    sides.away[i] = is_there ? size / a : 0.0f;
    sides.place[i] = is_there ? mixed / a : 0.0f;
  }
}

/// Lowers the bounds of the first or second of a row of quads' corners by paths across the side
/// from `a` to `b`, along which bounds are linear: along the path with the smallest rise, if it
/// crosses the side (Hopf and Lax's formula on a triangle: F. Bornemann and C. Rasch,
/// Finite-element discretization of static Hamilton-Jacobi equations based on a local variational
/// principle, 2006). `sign`: -1 for the side on the other side of the quads. Returns whether any
/// changed.
inline bool lower_over_sides(const float* __restrict a, const float* __restrict b,
                             const Sides& sides, float sign, const float* z, float* bound,
                             size_t first, size_t second) {
  // Fraction of a bound's rise per texel below which a change is not passed on.
  constexpr float kMinChange = 4e-3f;
  const float* __restrict const length = sides.length.data();
  const float* __restrict const away = sides.away.data();
  const float* __restrict const places = sides.place.data();
  // No path across a side is shorter than the perpendicular.
  int32_t may_lower = 0;
  for (int32_t i = 0; i < kReposeBlock; ++i) {
    const auto own = static_cast<size_t>(i);
    const float highest = std::max(bound[first + own], bound[second + own]);
    const float least = std::min(a[i], b[i]) + (1.0f + kMinChange) * away[i];
    may_lower |= ((std::abs(b[i] - a[i]) < length[i]) & (least < highest)) ? 1 : 0;
  }
  if (may_lower == 0) return false;
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
      const bool lowers = now < own[i] - kMinChange * away[i];
      changes |= lowers ? 1 : 0;
      own[i] = lowers ? now : own[i];
    }
    return changes != 0;
  };
  const bool lowers_first = lower(over_first, z + first, bound + first);
  return lower(over_second, z + second, bound + second) || lowers_first;
}

/// Whether any cell of a row has a bound.
inline bool is_bounded(const float* bound) {
  int32_t any = 0;
  for (int32_t i = 0; i < kReposeBlock + 2; ++i) any |= bound[i] < shared::kUnbounded ? 1 : 0;
  return any != 0;
}

/// The cells of a window in lines: its rows, or its columns. Bounds pass from each line to the next
/// and back, over three links of a cell and over the sides of quads along the line: every straight
/// path within 45 degrees of the direction of the sweep is followed to its end in one.
struct Lines {
  static constexpr int32_t kMax = kReposeBlock + 2;
  using Plane = std::array<float, static_cast<size_t>(kMax* TileWindow::kStride)>;
  /// The limits of links between a line and the next: from cell i to i; to i + 1; and from
  /// i + falls_from to the one before that. And of links along the line.
  struct Gap {
    const float* straight = nullptr;
    const float* rising = nullptr;
    const float* falling = nullptr;
    const float* along = nullptr;
  };

  int32_t count = 0;
  int32_t falls_from = 0;
  /// Lines whose bounds have been lowered.
  uint64_t lowered = 0;
  std::array<Gap, kMax> gaps;
  alignas(64) Plane bound;
  Plane top, z;

  /// `fresh`: lines with new bounds. `load(line)` provides a line's tops and bare surface, and the
  /// links to the next.
  template <typename Load>
  void sweep(uint64_t fresh, const Load& load) {
    up_ = down_ = fresh;
    while ((up_ | down_) != 0) {
      for (int32_t line = 0; line < count; ++line) {
        if ((up_ & row_bit(line)) != 0) pass_to(line, line + 1, load);
      }
      up_ &= ~row_bit(count - 1);
      for (int32_t line = count - 1; line >= 0; --line) {
        if ((down_ & row_bit(line)) != 0) pass_to(line, line - 1, load);
      }
    }
  }

 private:
  template <typename Load>
  void pass_to(int32_t line, int32_t next, const Load& load) {
    const bool is_up = next > line;
    (is_up ? up_ : down_) &= ~row_bit(line);
    if (next < 0 || next >= count) return;
    load(line);
    load(next);
    const size_t first = TileWindow::at(-1, line);
    std::array<float, kReposeBlock + 2> passed;
    if (!pass_row(&bound[first], &top[first], &z[first], passed.data())) return;
    const float* const from = passed.data() + 1;
    const int32_t low = std::min(line, next);
    const Gap& gap = gaps[static_cast<size_t>(low)];
    const size_t to = TileWindow::at(0, next);
    const int32_t falls_to = falls_from - 1;
    const int32_t step = is_up ? 1 : -1;
    bool lowers = lower_row(from, gap.straight, &z[to], &bound[to]);
    const int32_t rises_from = is_up ? 0 : 1;
    const int32_t other_from = is_up ? falls_from : falls_to;
    const auto shifted = [&](int32_t cells) {
      return static_cast<size_t>(static_cast<ptrdiff_t>(to) + cells);
    };
    lowers |= lower_row(from + rises_from, gap.rising, &z[shifted(rises_from + step)],
                        &bound[shifted(rises_from + step)]);
    lowers |= lower_row(from + other_from, gap.falling, &z[shifted(other_from - step)],
                        &bound[shifted(other_from - step)]);
    if ((measured_ & row_bit(low)) == 0) {
      measured_ |= row_bit(low);
      measure_line(gap.along, gap.straight, gap.rising, sides_[static_cast<size_t>(low)]);
    }
    lowers |= lower_over_sides(from, from + 1, sides_[static_cast<size_t>(low)],
                               is_up ? -1.0f : 1.0f, z.data(), bound.data(), to, to + 1);
    if (!lowers) return;
    lowered |= row_bit(next);
    up_ |= row_bit(next);
    down_ |= row_bit(next);
  }

  /// Lines with bounds to pass on to the next and to the one before; lines whose sides to the next
  /// are measured.
  uint64_t up_ = 0, down_ = 0, measured_ = 0;
  std::array<Sides, kMax> sides_;
};

/// Lowers the bounds of a block's window along its rows and its columns in turn, as long as any has
/// new bounds to pass on. Lines are loaded on demand.
class BoundSweep {
 public:
  explicit BoundSweep(const TilesAround& around)
      : around_(around), links_(around.at(0, 0)->links), outlets_(around.at(0, 0)->outlets) {
    rows_.count = TileWindow::kRows;
    columns_.count = Lines::kMax;
    columns_.falls_from = 1;
  }

  TileBounds run(const std::vector<OutletLink>& outlet_links) {
    for (const OutletLink& outlet : outlet_links) {
      const int32_t row = outlet.cell / kReposeBlock;
      lower(row, outlet.cell % kReposeBlock, outlet.top + shared::kCuts * outlet.limit);
    }
    uint64_t rows = rows_to_pass();
    for (bool is_first = true; rows != 0; is_first = false) {
      rows_.sweep(rows, [&](int32_t row) { load(row); });
      const uint64_t columns =
          turn_to_columns(is_first ? rows | rows_.lowered : kAllWindowRows, is_first);
      columns_.lowered = 0;
      columns_.sweep(columns, [&](int32_t line) { load_column(line); });
      rows = turn_to_rows();
    }
    return write();
  }

 private:
  /// Rows of the window with bounds that have not been passed on.
  uint64_t rows_to_pass() {
    uint64_t rows = outlets_.rows_to_pass.exchange(0, std::memory_order_relaxed) | rows_.lowered;
    for (int32_t row = 0; row < TileWindow::kRows; ++row) {
      if ((rows & row_bit(row)) == 0) continue;
      load_bound(row);
      if (!is_bounded(&rows_.bound[TileWindow::at(-1, row)])) rows &= ~row_bit(row);
    }
    return rows;
  }

  /// Copies the bounds to the columns; returns those with lower ones than before, or at first, with
  /// any in the rows `fresh`.
  uint64_t turn_to_columns(uint64_t fresh, bool is_first) {
    std::array<float, TileWindow::kRows> hidden;
    for (int32_t row = 0; row < TileWindow::kRows; ++row) {
      load_bound(row);
      hidden[static_cast<size_t>(row)] = (fresh & row_bit(row)) != 0 ? 0.0f : shared::kUnbounded;
    }
    uint64_t lower = 0;
    for (int32_t line = 0; line < Lines::kMax; ++line) {
      float* const to = &columns_.bound[TileWindow::at(0, line)];
      if (is_first) std::fill_n(to - 1, Lines::kMax, shared::kUnbounded);
      int32_t any = 0;
      for (int32_t row = 0; row < TileWindow::kRows; ++row) {
        const float now = rows_.bound[TileWindow::at(line - 1, row)];
        any |= now + hidden[static_cast<size_t>(row)] < to[row] ? 1 : 0;
        to[row] = now;
      }
      if (any != 0) lower |= row_bit(line);
    }
    return lower;
  }

  /// Copies the lowered columns back; returns the rows with lower bounds.
  uint64_t turn_to_rows() {
    uint64_t lower = 0;
    for (int32_t row = 0; columns_.lowered != 0 && row < TileWindow::kRows; ++row) {
      float* const to = &rows_.bound[TileWindow::at(-1, row)];
      int32_t any = 0;
      for (int32_t line = 0; line < Lines::kMax; ++line) {
        const float now = columns_.bound[TileWindow::at(row, line)];
        any |= now < to[line] ? 1 : 0;
        to[line] = now;
      }
      if (any != 0) lower |= row_bit(row);
    }
    rows_.lowered |= lower;
    return lower;
  }

  /// Writes the changes to the tiles.
  TileBounds write() {
    TileBounds result;
    for (int32_t row = 0; row < TileWindow::kRows; ++row) {
      if ((rows_.lowered & row_bit(row)) == 0) continue;
      load(row);
      around_.for_row(row, [&](ReposeTile* tile, size_t cell, int32_t column, size_t count) {
        const size_t at = TileWindow::at(column, row);
        for (size_t i = 0; tile != nullptr && i < count; ++i) {
          const float bound = rows_.bound[at + i];
          if (!(bound < tile->outlets.bound[cell + i])) continue;
          tile->outlets.bound[cell + i] = bound;
          tile->outlets.has_bounds.store(true, std::memory_order_relaxed);
          const float passed = shared::passed_bound(bound, rows_.top[at + i], rows_.z[at + i]);
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
    around_.copy_row(row, &ReposeTile::outlets, &TileOutlets::bound, rows_.bound,
                     shared::kUnbounded);
  }
  void load(int32_t row) {
    load_bound(row);
    if ((loaded_ & row_bit(row)) != 0) return;
    loaded_ |= row_bit(row);
    around_.copy_row(row, &ReposeTile::snow, &TileSnow::top, rows_.top, 0.0f);
    around_.copy_row(row, &ReposeTile::ground, &TileGround::z, rows_.z, 0.0f);
    if (row == kReposeBlock) return;
    rows_.gaps[static_cast<size_t>(row)] = {limit(1, row), limit(2, row), limit(3, row),
                                            limit(0, row)};
  }
  void load_column(int32_t line) {
    if ((turned_ & row_bit(line)) != 0) return;
    turned_ |= row_bit(line);
    for (int32_t row = 0; row < TileWindow::kRows; ++row) load(row);
    const int32_t column = line - 1;
    float* const top = &columns_.top[TileWindow::at(0, line)];
    float* const z = &columns_.z[TileWindow::at(0, line)];
    top[-1] = z[-1] = 0.0f;
    for (int32_t row = 0; row < TileWindow::kRows; ++row) {
      top[row] = rows_.top[TileWindow::at(column, row)];
      z[row] = rows_.z[TileWindow::at(column, row)];
    }
    if (line + 1 == Lines::kMax) return;
    std::array<std::array<float, kReposeBlock>, kForwardLinks>& limits =
        column_limits_[static_cast<size_t>(line)];
    const auto turn = [&](int32_t k, int32_t from) {
      std::array<float, kReposeBlock>& to = limits[static_cast<size_t>(k)];
      const bool is_there = from >= 0 && from < kReposeBlock;
      for (int32_t row = 0; row < kReposeBlock; ++row) {
        to[static_cast<size_t>(row)] = is_there ? limit(k, row)[from] : kNoLink;
      }
      return to.data();
    };
    columns_.gaps[static_cast<size_t>(line)] = {turn(0, column), turn(2, column),
                                                turn(3, column + 1), turn(1, column)};
  }
  const float* limit(int32_t k, int32_t row) const {
    return links_.limit[static_cast<size_t>(k)].data() + static_cast<size_t>(row * kReposeBlock);
  }
  void lower(int32_t row, int32_t column, float bound) {
    load_bound(row);
    float& own = rows_.bound[TileWindow::at(column, row)];
    if (!(bound < own)) return;
    own = bound;
    rows_.lowered |= row_bit(row);
  }

  const TilesAround& around_;
  const TileLinks& links_;
  TileOutlets& outlets_;
  /// Rows whose bounds, and all planes, are loaded; and columns that are.
  uint64_t bounds_ = 0, loaded_ = 0, turned_ = 0;
  Lines rows_, columns_;
  /// By line of columns.
  std::array<std::array<std::array<float, kReposeBlock>, kForwardLinks>, Lines::kMax>
      column_limits_;
};

SNOWBOUGH_SWEEP TileBounds sweep_bounds(const TilesAround& around,
                                        const std::vector<OutletLink>& outlet_links) {
  return BoundSweep(around).run(outlet_links);
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
                             const std::vector<OutletLink>& outlet_links) {
  const TilesAround around(tiles, blocks_a_side, block);
  if (outlet_links.empty() && !has_bounds(around)) return {};
  return sweep_bounds(around, outlet_links);
}

}  // namespace snowbough::snow
