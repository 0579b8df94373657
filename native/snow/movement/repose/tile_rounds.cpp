#include <algorithm>
#include <bit>
#include <cmath>

#include "base/simd.h"
#include "shaders/lib/texel_repose.h"
#include "snow/movement/repose/granular.h"
#include "snow/movement/repose/tiles_around.h"

#define SNOWBOUGH_ROW SNOWBOUGH_WIDE_FLAT

namespace snowbough::snow {
namespace {

using Local = TileWindow::Plane;

/// A number's bits without its sign: 0 only for 0. Or-ing them finds any non-zero number; a maximum
/// would not vectorise.
inline uint32_t bits_of(float value) {
  return std::bit_cast<uint32_t>(value) & 0x7FFFFFFFu;
}

/// Computes the requested flow from a row of a block's cells, if they have a unit, to their
/// neighbours `step` cells away, and adds it to the demand of either. `part`: of the usual rate, by
/// column. Returns whether there is any.
template <typename Part>
inline bool want_row(int32_t step, const float* __restrict top, const float* __restrict gives,
                     const float* __restrict limit, const float* __restrict stiffness,
                     float* __restrict flow, float momentum, float* wanted, const Part& part) {
  uint32_t any = 0;
  for (int32_t i = 0; i < kReposeBlock; ++i) {
    const float rate = part(i) * shared::link_rate(stiffness[i], stiffness[i + step]);
    const float fall = top[i] - top[i + step];
    const float had = fall < 0.0f ? gives[i + step] : gives[i];
    const float next = shared::wanted_flow(flow[i], fall, limit[i], rate, momentum);
    flow[i] = had < 1.0f ? 0.0f : next;
    any |= bits_of(flow[i]);
  }
  if (any == 0) return false;
  for (int32_t i = 0; i < kReposeBlock; ++i) wanted[i] += flow[i] > 0.0f ? flow[i] : 0.0f;
  for (int32_t i = 0; i < kReposeBlock; ++i) wanted[i + step] -= flow[i] < 0.0f ? flow[i] : 0.0f;
  return true;
}

/// The fraction of the demand that cells can give.
inline void part_row(int32_t cells, const float* __restrict gives, float* __restrict wanted,
                     float* __restrict part) {
  for (int32_t i = 0; i < cells; ++i) {
    part[i] = shared::given_part(gives[i], wanted[i]);
    wanted[i] = 0.0f;
  }
}

/// Applies the flow; returns whether there is any.
inline bool give_row(int32_t step, float* __restrict flow, const float* __restrict part,
                     float* gain) {
  uint32_t any = 0;
  for (int32_t i = 0; i < kReposeBlock; ++i) {
    flow[i] = shared::given_flow(flow[i], part[i], part[i + step]);
    any |= bits_of(flow[i]);
  }
  if (any == 0) return false;
  for (int32_t i = 0; i < kReposeBlock; ++i) gain[i] -= flow[i];
  for (int32_t i = 0; i < kReposeBlock; ++i) gain[i + step] += flow[i];
  return true;
}

/// Adds the gains to the units that have come, and updates the tops.
inline void move_row(int32_t cells, float* __restrict gain, int32_t* __restrict come,
                     const float* __restrict held, const float* __restrict z,
                     const float* __restrict lift, float* __restrict top, float* __restrict gives) {
  for (int32_t i = 0; i < cells; ++i) {
    come[i] += static_cast<int32_t>(gain[i]);
    gain[i] = 0.0f;
    const float now = held[i] + static_cast<float>(come[i]);
    top[i] = z[i] + lift[i] * now;
    gives[i] = ((now > 0.0f) & (lift[i] > 0.0f)) ? now : 0.0f;
  }
}

/// Whether a height difference between a row of cells and their neighbours exceeds its limit, with
/// snow on it.
inline bool is_row_over(int32_t step, const float* __restrict top, const float* __restrict gives,
                        const float* __restrict limit) {
  int32_t over = 0;
  for (int32_t i = 0; i < kReposeBlock; ++i) {
    const float fall = top[i] - top[i + step];
    const float had = fall < 0.0f ? gives[i + step] : gives[i];
    over |= ((std::abs(fall) > limit[i]) & (had >= 1.0f)) ? 1 : 0;
  }
  return over != 0;
}

/// Calls visit(row) for the bits of `rows`, ascending.
template <typename Visit>
void for_bits(uint64_t rows, const Visit& visit) {
  for (; rows != 0; rows &= rows - 1) visit(std::countr_zero(rows));
}

int32_t row_of(const OutletLink& outlet) {
  return outlet.cell / kReposeBlock;
}

size_t place_of(const OutletLink& outlet) {
  return TileWindow::at(outlet.cell % kReposeBlock, row_of(outlet));
}

/// The rounds of a block on a window whose rows are loaded on demand: in most blocks snow moves in
/// a few rows.
class TileRun {
 public:
  TileRun(const ReposeTiles& tiles, int32_t block, int32_t blocks_a_side,
          std::vector<OutletLink>& outlet_links)
      : around_(tiles, blocks_a_side, block),
        links_(around_.at(0, 0)->links),
        outlet_links_(outlet_links) {}

  TileRounds run(int first_round, int rounds) {
    const uint32_t active_rows =
        links_.active_rows.load(std::memory_order_relaxed) | links_.partial_rows;
    // Whether grains rest is not known before their gradient is.
    look_ =
        links_.flowing | (is_granular() ? active_rows : over_rows(active_rows & ~links_.flowing));
    for_bits(look_, [&](int32_t row) {
      is_wanted_[static_cast<size_t>(row)].fill((links_.flowing & row_bit(row)) != 0);
    });
    TileRounds result;
    result.flows = look_ != 0;
    if (result.flows && links_.flow == nullptr) {
      links_.flow = std::make_unique<std::array<TilePlane, kForwardLinks>>();
    }
    while (result.flows && result.rounds < rounds) {
      result.flows = run_round(shared::flow_momentum(first_round + result.rounds));
      ++result.rounds;
    }
    result.has_changed = changed_ != 0;
    links_.active_rows.store(result.flows ? static_cast<uint32_t>(look_) : 0,
                             std::memory_order_relaxed);
    links_.flowing = result.flows ? static_cast<uint32_t>(wants_) : 0;
    links_.partial_rows = result.flows ? 0 : static_cast<uint32_t>(wants_);
    for_bits(changed_, [&](int32_t row) { write_row(row); });
    return result;
  }

 private:
  void load_top(int32_t row) {
    if ((tops_ & row_bit(row)) != 0) return;
    tops_ |= row_bit(row);
    around_.copy_row(row, &ReposeTile::snow, &TileSnow::top, top_, 0.0f);
    around_.copy_row(row, &ReposeTile::snow, &TileSnow::gives, gives_, 0.0f);
  }
  void load(int32_t row) {
    if ((loaded_ & row_bit(row)) != 0) return;
    loaded_ |= row_bit(row);
    load_top(row);
    around_.for_row(row, [&](const ReposeTile* tile, size_t cell, int32_t column, size_t count) {
      for (size_t i = 0, at = TileWindow::at(column, row); i < count; ++i, ++at) {
        const size_t own = cell + i;
        come_[at] = 0;
        gain_[at] = wanted_[at] = 0.0f;
        z_[at] = tile == nullptr ? 0.0f : tile->ground.z[own];
        lift_[at] = tile == nullptr ? 0.0f : tile->snow.lift[own];
        held_[at] = tile == nullptr
                        ? 0.0f
                        : tile->snow.held[own] + static_cast<float>(tile->snow.moved[own]);
        stiffness_[at] = tile == nullptr ? 0.0f : tile->stiffness(own);
      }
    });
    if (is_granular()) load_granular(row);
  }

  bool is_granular() const { return links_.granular_slope > 0.0f; }
  void load_granular(int32_t row) {
    around_.copy_row(row, &ReposeTile::ground, &TileGround::x, granular_.x, 0.0f);
    around_.copy_row(row, &ReposeTile::ground, &TileGround::y, granular_.y, 0.0f);
    around_.for_row(row, [&](const ReposeTile* tile, size_t cell, int32_t column, size_t count) {
      const size_t at = TileWindow::at(column, row);
      if (tile == nullptr) {
        std::fill_n(&granular_.holds[at], count, 0.0f);
        std::fill_n(&granular_.is_square[at], count, 0.0f);
        return;
      }
      mark_grains(&tile->ground.area[cell], &tile->snow.kind[cell], &tile->ground.forward[cell],
                  count, &granular_.holds[at], &granular_.is_square[at]);
    });
  }

  /// The rows among these with links over their limits.
  uint64_t over_rows(uint32_t rows) {
    uint64_t over = 0;
    for_bits(rows, [&](int32_t row) {
      load_top(row);
      load_top(row + 1);
      for (int32_t k = 0; k < kForwardLinks; ++k) {
        const auto cells = static_cast<size_t>(row * kReposeBlock);
        if (is_row_over(TileWindow::step(k), top_.data() + TileWindow::at(0, row),
                        gives_.data() + TileWindow::at(0, row),
                        links_.limit[static_cast<size_t>(k)].data() + cells)) {
          over |= row_bit(row);
          return;
        }
      }
    });
    for (const OutletLink& outlet : outlet_links_) {
      if ((row_bit(row_of(outlet)) & rows) == 0) continue;
      const size_t at = place_of(outlet);
      if (top_[at] - outlet.top > outlet.limit && gives_[at] >= 1.0f)
        over |= row_bit(row_of(outlet));
    }
    return over;
  }

  float* flow(int32_t k, int32_t row) {
    return (*links_.flow)[static_cast<size_t>(k)].data() + static_cast<size_t>(row * kReposeBlock);
  }

  /// Computes the requested flows; returns their rows.
  uint64_t want(float momentum) {
    uint64_t wants = 0;
    GranularSquares squares;
    for_bits(look_, [&](int32_t row) {
      load(row);
      load(row + 1);
      if (is_granular() && row > 0) load(row - 1);
      const size_t at = TileWindow::at(0, row);
      std::array<bool, kForwardLinks>& is_wanted = is_wanted_[static_cast<size_t>(row)];
      if (is_granular()) squares.find(granular_, top_, row);
      for (int32_t k = 0; k < kForwardLinks; ++k) {
        const auto link = static_cast<size_t>(k);
        const float* const limit =
            links_.limit[link].data() + static_cast<size_t>(row * kReposeBlock);
        if (is_granular()) {
          GranularRow row_of_grains;
          find_granular_row(granular_, squares, top_, row, k, links_.granular_slope, limit,
                            row_of_grains);
          const float* const rates = row_of_grains.rate.data();
          is_wanted[link] = want_row(TileWindow::step(k), &top_[at], &gives_[at],
                                     row_of_grains.limit.data(), &stiffness_[at], flow(k, row),
                                     momentum, &wanted_[at], [&](int32_t i) { return rates[i]; });
          if (is_wanted[link]) wants |= row_bit(row);
          continue;
        }
        // Links without flow in the previous round rarely start.
        is_wanted[link] =
            (is_wanted[link] || is_row_over(TileWindow::step(k), &top_[at], &gives_[at], limit)) &&
            want_row(TileWindow::step(k), &top_[at], &gives_[at], limit, &stiffness_[at],
                     flow(k, row), momentum, &wanted_[at], [](int32_t) { return 1.0f; });
        if (is_wanted[link]) wants |= row_bit(row);
      }
    });
    return wants;
  }

  uint64_t want_over_outlets(float momentum) {
    uint64_t wants = 0;
    for (OutletLink& outlet : outlet_links_) {
      if ((look_ & row_bit(row_of(outlet))) == 0) continue;
      const size_t at = place_of(outlet);
      const float wanted = shared::wanted_flow(outlet.flow, top_[at] - outlet.top, outlet.limit,
                                               outlet.rate, momentum);
      outlet.flow = gives_[at] < 1.0f ? 0.0f : std::max(wanted, 0.0f);
      wanted_[at] += outlet.flow;
      if (outlet.flow > 0.0f) wants |= row_bit(row_of(outlet));
    }
    return wants;
  }

  /// Applies the flows; returns the rows whose cells changed.
  uint64_t give(uint64_t wants, uint64_t outlet_wants) {
    uint64_t gave = 0;
    for_bits(wants, [&](int32_t row) {
      const size_t at = TileWindow::at(0, row);
      for (int32_t k = 0; k < kForwardLinks; ++k) {
        if (!is_wanted_[static_cast<size_t>(row)][static_cast<size_t>(k)]) continue;
        if (give_row(TileWindow::step(k), flow(k, row), part_.data() + at, gain_.data() + at)) {
          gave |= row_bit(row) | row_bit(row + 1);
        }
      }
    });
    for (OutletLink& outlet : outlet_links_) {
      if ((outlet_wants & row_bit(row_of(outlet))) == 0) continue;
      const size_t at = place_of(outlet);
      outlet.flow = shared::given_flow(outlet.flow, part_[at], 1.0f);
      gain_[at] -= outlet.flow;
      outlet.fallen += static_cast<double>(outlet.flow);
      if (outlet.flow > 0.0f) gave |= row_bit(row_of(outlet));
    }
    return gave;
  }

  bool run_round(float momentum) {
    links_.flow_rows |= static_cast<uint32_t>(look_);
    const uint64_t links = want(momentum);
    const uint64_t outlets = want_over_outlets(momentum);
    wants_ = links | outlets;
    if (wants_ == 0) return false;
    constexpr int32_t kCells = kReposeBlock + 2;
    for_bits(links | links << 1 | outlets, [&](int32_t row) {
      const size_t at = TileWindow::at(-1, row);
      part_row(kCells, gives_.data() + at, wanted_.data() + at, part_.data() + at);
    });
    const uint64_t moved = give(links, outlets);
    if (moved == 0) return false;
    for_bits(moved, [&](int32_t row) {
      const size_t at = TileWindow::at(-1, row);
      move_row(kCells, gain_.data() + at, come_.data() + at, held_.data() + at, z_.data() + at,
               lift_.data() + at, top_.data() + at, gives_.data() + at);
    });
    changed_ |= moved;
    look_ = (wants_ | moved | moved >> 1) & kAllRows;
    return true;
  }

  void write_row(int32_t row) {
    around_.for_row(row, [&](ReposeTile* tile, size_t cell, int32_t column, size_t count) {
      const size_t at = TileWindow::at(column, row);
      for (size_t i = 0; tile != nullptr && i < count; ++i) {
        if (come_[at + i] == 0) continue;
        tile->add(cell + i, static_cast<double>(come_[at + i]));
        const int32_t own = column + static_cast<int32_t>(i);
        if (TileWindow::is_border(own, row)) activate_others(own, row);
      }
    });
  }
  /// The tile evaluates its own rows anyway.
  void activate_others(int32_t column, int32_t row) {
    const uint32_t own = links_.active_rows.load(std::memory_order_relaxed);
    activate_cell(around_, column, row);
    links_.active_rows.store(own, std::memory_order_relaxed);
  }

  const TilesAround around_;
  TileLinks& links_;
  std::vector<OutletLink>& outlet_links_;
  /// Rows to evaluate in the next round; rows with requests in the last; rows with movement; and
  /// rows whose tops (with the units that cells can give) and all planes are loaded.
  uint64_t look_ = 0, wants_ = 0, changed_ = 0, tops_ = 0, loaded_ = 0;
  /// Per row and link; false without flow.
  std::array<std::array<bool, kForwardLinks>, kReposeBlock> is_wanted_{};
  alignas(64) Local top_;
  /// Only for grains.
  GranularWindow granular_;
  Local gives_, z_, lift_, stiffness_, held_, gain_, wanted_, part_;
  /// Units that have come in these rounds.
  std::array<int32_t, TileWindow::kRows * TileWindow::kStride> come_;
};

SNOWBOUGH_ROW TileRounds run_rounds_of(const ReposeTiles& tiles, int32_t block,
                                       int32_t blocks_a_side, std::vector<OutletLink>& outlet_links,
                                       int first_round, int rounds) {
  return TileRun(tiles, block, blocks_a_side, outlet_links).run(first_round, rounds);
}

}  // namespace

TileRounds run_tile_rounds(const ReposeTiles& tiles, int32_t block, int32_t blocks_a_side,
                           std::vector<OutletLink>& outlet_links, int first_round, int rounds) {
  return run_rounds_of(tiles, block, blocks_a_side, outlet_links, first_round, rounds);
}

}  // namespace snowbough::snow
