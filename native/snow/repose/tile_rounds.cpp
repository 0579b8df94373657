#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "base/simd.h"
#include "shaders/lib/texel_repose.h"
#include "snow/repose/tile.h"
#include "snow/repose/window.h"

#if defined(__GNUC__)
#define SNOWBOUGH_ROW SNOWBOUGH_WIDE __attribute__((flatten))
#else
#define SNOWBOUGH_ROW SNOWBOUGH_WIDE
#endif

namespace snowbough::snow {
namespace {

using Local = TileWindow::Plane;

constexpr float kNoLink = std::numeric_limits<float>::infinity();

struct alignas(64) Window {
  Local top, gives, z, lift, share, held, gain, wanted, part;
  /// Units that have come in these rounds.
  std::array<int32_t, TileWindow::kRows * TileWindow::kStride> come;
};

/// A number's bits without its sign: 0 only for 0. Or-ed, they say whether any is another; looking
/// for the largest would be done cell by cell.
inline uint32_t bits_of(float value) {
  return std::bit_cast<uint32_t>(value) & 0x7FFFFFFFu;
}

/// What would flow from a row of a block's cells to their neighbours, `step` cells away; adds what
/// is wanted of either. Returns whether there is anything.
SNOWBOUGH_ROW bool want_row(int32_t step, const float* __restrict top,
                            const float* __restrict limit, const float* __restrict rate,
                            float* __restrict flow, float momentum, float* wanted) {
  uint32_t any = 0;
  for (int32_t i = 0; i < kReposeBlock; ++i) {
    const float next =
        shared::wanted_flow(flow[i], top[i] - top[i + step], limit[i], rate[i], momentum);
    flow[i] = next;
    any |= bits_of(next);
  }
  if (any == 0) return false;
  for (int32_t i = 0; i < kReposeBlock; ++i) wanted[i] += flow[i] > 0.0f ? flow[i] : 0.0f;
  for (int32_t i = 0; i < kReposeBlock; ++i) wanted[i + step] -= flow[i] < 0.0f ? flow[i] : 0.0f;
  return true;
}

/// Which part of what is wanted of them cells can give.
SNOWBOUGH_ROW void part_row(int32_t cells, const float* __restrict gives, float* __restrict wanted,
                            float* __restrict part) {
  for (int32_t i = 0; i < cells; ++i) {
    part[i] = shared::given_part(gives[i], wanted[i]);
    wanted[i] = 0.0f;
  }
}

/// Lets it flow; returns whether anything does.
SNOWBOUGH_ROW bool give_row(int32_t step, float* __restrict flow, const float* __restrict part,
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

/// Adds the gains to what has come, and lifts the tops.
SNOWBOUGH_ROW void move_row(int32_t cells, float* __restrict gain, int32_t* __restrict come,
                            const float* __restrict held, const float* __restrict z,
                            const float* __restrict lift, const float* __restrict share,
                            float* __restrict top, float* __restrict gives) {
  for (int32_t i = 0; i < cells; ++i) {
    come[i] += static_cast<int32_t>(gain[i]);
    gain[i] = 0.0f;
    const float now = held[i] + static_cast<float>(come[i]);
    top[i] = z[i] + lift[i] * now;
    gives[i] = now > 0.0f ? share[i] * now : 0.0f;
  }
}

void load(const ReposeTiles& tiles, int32_t blocks, int32_t block, Window& window) {
  window = Window{};
  TileWindow::for_runs(
      tiles, blocks, block, [&](const ReposeTile& tile, size_t cell, size_t at, size_t count) {
        TileWindow::copy_run(tile.top, cell, count, window.top, at);
        TileWindow::copy_run(tile.gives, cell, count, window.gives, at);
        TileWindow::copy_run(tile.z, cell, count, window.z, at);
        TileWindow::copy_run(tile.lift, cell, count, window.lift, at);
        TileWindow::copy_run(tile.share, cell, count, window.share, at);
        for (size_t i = 0; i < count; ++i) {
          window.held[at + i] = tile.held[cell + i] + static_cast<float>(tile.moved[cell + i]);
        }
      });
}

/// Whether a fall from a row of cells to their neighbours is over its limit.
SNOWBOUGH_ROW bool is_row_over(int32_t step, const float* __restrict top,
                               const float* __restrict limit) {
  int32_t over = 0;
  for (int32_t i = 0; i < kReposeBlock; ++i)
    over |= std::abs(top[i] - top[i + step]) > limit[i] ? 1 : 0;
  return over != 0;
}

bool run_round(ReposeTile& tile, Window& window, std::vector<RimLink>& rims, float momentum) {
  bool is_wanted[kReposeBlock][kForwardLinks];
  bool flows = false;
  for (int32_t row = 0; row < kReposeBlock; ++row) {
    const size_t at = TileWindow::at(0, row);
    const auto cells = static_cast<size_t>(row * kReposeBlock);
    for (int32_t k = 0; k < kForwardLinks; ++k) {
      const auto link = static_cast<size_t>(k);
      is_wanted[row][k] =
          want_row(TileWindow::step(k), window.top.data() + at, tile.limit[link].data() + cells,
                   tile.rate[link].data() + cells, tile.flow[link].data() + cells, momentum,
                   window.wanted.data() + at);
      flows = flows || is_wanted[row][k];
    }
  }
  for (RimLink& rim : rims) {
    const size_t at = TileWindow::at(rim.cell % kReposeBlock, rim.cell / kReposeBlock);
    rim.flow = std::max(
        shared::wanted_flow(rim.flow, window.top[at] - rim.top, rim.limit, rim.rate, momentum),
        0.0f);
    window.wanted[at] += rim.flow;
    flows = flows || rim.flow > 0.0f;
  }
  if (!flows) return false;
  for (int32_t row = 0; row < TileWindow::kRows; ++row) {
    const size_t at = TileWindow::at(-1, row);
    part_row(kReposeBlock + 2, window.gives.data() + at, window.wanted.data() + at,
             window.part.data() + at);
  }
  flows = false;
  for (int32_t row = 0; row < kReposeBlock; ++row) {
    const size_t at = TileWindow::at(0, row);
    for (int32_t k = 0; k < kForwardLinks; ++k) {
      if (!is_wanted[row][k]) continue;
      float* const flow =
          tile.flow[static_cast<size_t>(k)].data() + static_cast<size_t>(row * kReposeBlock);
      flows |=
          give_row(TileWindow::step(k), flow, window.part.data() + at, window.gain.data() + at);
    }
  }
  for (RimLink& rim : rims) {
    const size_t at = TileWindow::at(rim.cell % kReposeBlock, rim.cell / kReposeBlock);
    rim.flow = shared::given_flow(rim.flow, window.part[at], 1.0f);
    window.gain[at] -= rim.flow;
    flows = flows || rim.flow > 0.0f;
  }
  if (!flows) return false;
  for (int32_t row = 0; row < TileWindow::kRows; ++row) {
    const size_t at = TileWindow::at(-1, row);
    move_row(kReposeBlock + 2, window.gain.data() + at, window.come.data() + at,
             window.held.data() + at, window.z.data() + at, window.lift.data() + at,
             window.share.data() + at, window.top.data() + at, window.gives.data() + at);
  }
  return true;
}

/// What the links of a block are set up from, cell by cell of a window.
struct alignas(64) Bare {
  Local x, y, z, stiffness, area;
  /// 1 on walls, else 0.
  Local wall;
};

/// The limits and rates of the links of a row of cells to those `step` cells away. Nothing moves on
/// walls, and what lies at the foot of one leans against it.
SNOWBOUGH_ROW void set_up_row(const Bare& bare, size_t at, int32_t step, const uint8_t* forward,
                              int32_t k, float slope, float* __restrict limit,
                              float* __restrict rate) {
  const float* const x = bare.x.data() + at;
  const float* const y = bare.y.data() + at;
  const float* const z = bare.z.data() + at;
  const float* const stiffness = bare.stiffness.data() + at;
  const float* const area = bare.area.data() + at;
  const float* const wall = bare.wall.data() + at;
  for (int32_t i = 0; i < kReposeBlock; ++i) {
    const int32_t j = i + step;
    const float way_x = x[j] - x[i];
    const float way_y = y[j] - y[i];
    const float falls = z[i] - z[j];
    const float allowed = shared::link_limit(std::sqrt(way_x * way_x + way_y * way_y), slope);
    // One of them a wall, and the other not over it; or both.
    const float over_wall = wall[j] > wall[i] ? falls : (wall[i] > wall[j] ? -falls : 1.0f);
    const bool is_open = (over_wall > 0.0f) & (wall[i] + wall[j] < 1.5f) & (area[i] > 0.0f) &
                         (area[j] > 0.0f) & (((forward[i] >> k) & 1) != 0);
    limit[i] = is_open ? allowed : kNoLink;
    rate[i] = shared::link_rate(stiffness[i], stiffness[j]);
  }
}

}  // namespace

void ReposeTile::begin_pose() {
  area.fill(0.0f);
  forward.fill(0);
  two_sided.fill(0);
  part.fill(1.0f / shared::kLinks);
  kind.fill(kUnknown);
  bound.fill(shared::kUnbounded);
  has_pose = true;
  has_links = false;
}

void ReposeTile::set_kind(size_t cell, uint8_t now, float unit) {
  kind[cell] = now;
  const bool wall = (now & kWall) != 0;
  const float side = (now & kBack) != 0 ? -1.0f : 1.0f;
  units_a_metre[cell] = area[cell] / unit;
  lift[cell] = wall ? 0.0f : shared::column_height(side * normal_z[cell]) * (unit / area[cell]);
  share[cell] = wall ? 0.0f : 1.0f;
  stiffness[cell] = lift[cell] / part[cell];
}

bool ReposeTile::cover(size_t cell, float height, float unit) {
  const float side = shared::snow_side(height, up[cell], two_sided[cell] != 0);
  const bool wall = shared::is_wall(side * up[cell]) || area[cell] <= 0.0f;
  const auto now = static_cast<uint8_t>((wall ? kWall : 0) | (side < 0.0f ? kBack : 0));
  const bool changes = now != kind[cell];
  if (changes) set_kind(cell, now, unit);
  held[cell] = std::abs(height) * units_a_metre[cell];
  moved[cell] = 0.0;
  // A wall is an outlet: what lies over it falls.
  bound[cell] = wall ? z[cell] : shared::kUnbounded;
  raise(cell);
  return changes;
}

void set_up_tile_links(const ReposeTiles& tiles, int32_t block, int32_t blocks_a_side,
                       float slope) {
  Bare bare{};
  TileWindow::for_cells(tiles, blocks_a_side, block,
                        [&](const ReposeTile& tile, size_t cell, size_t at) {
                          bare.x[at] = tile.x[cell];
                          bare.y[at] = tile.y[cell];
                          bare.z[at] = tile.z[cell];
                          bare.stiffness[at] = tile.stiffness[cell];
                          bare.area[at] = tile.area[cell];
                          bare.wall[at] = (tile.kind[cell] & kWall) != 0 ? 1.0f : 0.0f;
                        });
  ReposeTile& tile = *tiles[static_cast<size_t>(block)];
  tile.has_links = true;
  for (int32_t row = 0; row < kReposeBlock; ++row) {
    const auto cells = static_cast<size_t>(row * kReposeBlock);
    for (int32_t k = 0; k < kForwardLinks; ++k) {
      const auto link = static_cast<size_t>(k);
      set_up_row(bare, TileWindow::at(0, row), TileWindow::step(k), tile.forward.data() + cells, k,
                 slope, tile.limit[link].data() + cells, tile.rate[link].data() + cells);
    }
  }
}

bool is_at_rest(const ReposeTiles& tiles, int32_t block, int32_t blocks_a_side,
                const std::vector<RimLink>& rims) {
  Local top{};
  TileWindow::for_runs(tiles, blocks_a_side, block,
                       [&](const ReposeTile& tile, size_t cell, size_t at, size_t count) {
                         TileWindow::copy_run(tile.top, cell, count, top, at);
                       });
  const ReposeTile& tile = *tiles[static_cast<size_t>(block)];
  for (int32_t row = 0; row < kReposeBlock; ++row) {
    const auto cells = static_cast<size_t>(row * kReposeBlock);
    for (int32_t k = 0; k < kForwardLinks; ++k) {
      const float* const limit = tile.limit[static_cast<size_t>(k)].data() + cells;
      if (is_row_over(TileWindow::step(k), top.data() + TileWindow::at(0, row), limit))
        return false;
    }
  }
  return std::none_of(rims.begin(), rims.end(), [&](const RimLink& rim) {
    return tile.top[static_cast<size_t>(rim.cell)] - rim.top > rim.limit;
  });
}

TileRounds run_tile_rounds(const ReposeTiles& tiles, int32_t block, int32_t blocks_a_side,
                           std::vector<RimLink>& rims, int first_round, int rounds) {
  Window window;
  load(tiles, blocks_a_side, block, window);
  ReposeTile& tile = *tiles[static_cast<size_t>(block)];
  TileRounds result;
  result.flows = true;
  while (result.flows && result.rounds < rounds) {
    result.flows =
        run_round(tile, window, rims, shared::flow_momentum(first_round + result.rounds));
    ++result.rounds;
    result.has_changed = result.has_changed || result.flows;
  }
  if (!result.has_changed) return result;
  TileWindow::for_cells(tiles, blocks_a_side, block, [&](ReposeTile& part, size_t cell, size_t at) {
    if (window.come[at] == 0) return;
    part.moved[cell] += static_cast<double>(window.come[at]);
    part.raise(cell);
    result.border_has_changed = result.border_has_changed || TileWindow::is_border(at);
  });
  return result;
}

}  // namespace snowbough::snow
