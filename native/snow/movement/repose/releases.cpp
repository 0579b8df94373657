#include "snow/movement/repose/releases.h"

#include <algorithm>
#include <map>
#include <utility>

#include "base/simd.h"
#include "snow/movement/rays/map_point.h"
#include "snow/movement/repose/repose.h"
#include "snow/movement/repose/tiles_around.h"

namespace snowbough::snow {
namespace {

constexpr int32_t kNoCell = -1;

/// A row of cells and a margin of one on either side.
using MarginRow = std::array<float, kReposeBlock + 2>;

/// Copies a row, -1 to kReposeBlock, of a plane of a part of the tiles; `absent` where it has none.
template <typename Part, typename PlaneOf>
void copy_row(const TilesAround& around, int32_t row, const Part& has, const PlaneOf& plane_of,
              float absent, MarginRow& to) {
  const int32_t dy = row < 0 ? -1 : row / kReposeBlock;
  const auto first = static_cast<size_t>((row & (kReposeBlock - 1)) * kReposeBlock);
  const ReposeTile* const left = around.at(-1, dy);
  const ReposeTile* const own = around.at(0, dy);
  const ReposeTile* const right = around.at(1, dy);
  to.front() = has(left) ? plane_of(*left)[first + kReposeBlock - 1] : absent;
  if (has(own)) {
    std::copy_n(plane_of(*own).begin() + first, kReposeBlock, to.begin() + 1);
  } else {
    std::fill_n(to.begin() + 1, kReposeBlock, absent);
  }
  to.back() = has(right) ? plane_of(*right)[first] : absent;
}

/// The tops of a row, of those below and above it; and the limits of the row's links to the forward
/// neighbours, and from those to which it is one. Rows begin with column -1.
struct RowLinks {
  std::array<MarginRow, 3> top;
  std::array<std::array<float, kReposeBlock>, kForwardLinks> forward;
  std::array<MarginRow, kForwardLinks> back;

  RowLinks(const TilesAround& around, int32_t row) {
    const auto is_there = [](const ReposeTile* tile) { return tile != nullptr; };
    const auto is_linked = [](const ReposeTile* tile) {
      return tile != nullptr && tile->links.has_limits;
    };
    for (int32_t i = -1; i <= 1; ++i) {
      copy_row(
          around, row + i, is_there,
          [](const ReposeTile& tile) -> const TilePlane& { return tile.snow.top; }, 0.0f,
          top[static_cast<size_t>(i + 1)]);
    }
    for (int32_t k = 0; k < kForwardLinks; ++k) {
      const auto link = static_cast<size_t>(k);
      const auto limit_of = [&](const ReposeTile& tile) -> const TilePlane& {
        return tile.links.limit[link];
      };
      copy_row(around, row - kForwardRow[k], is_linked, limit_of, kNoLink, back[link]);
      MarginRow own;
      copy_row(around, row, is_linked, limit_of, kNoLink, own);
      std::copy_n(own.begin() + 1, kReposeBlock, forward[link].begin());
      // Links onto tiles that are not there.
      const int32_t dy = (row + kForwardRow[k]) / kReposeBlock;
      if (!is_there(around.at(0, dy))) forward[link].fill(kNoLink);
      if (kForwardColumn[k] > 0 && !is_there(around.at(1, dy))) forward[link].back() = kNoLink;
      if (kForwardColumn[k] < 0 && !is_there(around.at(-1, dy))) forward[link].front() = kNoLink;
    }
  }
};

/// Considers the ways `way` of a row's cells, to cells of `other` along links with `limit`.
inline void consider_row(const float* __restrict top, const float* __restrict other,
                         const float* __restrict limit, int32_t way, float* __restrict steepest,
                         int32_t* __restrict best) {
  for (int32_t i = 0; i < kReposeBlock; ++i) {
    // Limits grow with the distance, so their ratio with the fall ranks slopes.
    const float fall = top[i] - other[i];
    const bool is_steeper = (limit[i] < kNoLink) & (fall > steepest[i] * limit[i]);
    steepest[i] = is_steeper ? fall / limit[i] : steepest[i];
    best[i] = is_steeper ? way : best[i];
  }
}

SNOWBOUGH_WIDE_FLAT void find_ways(const RowLinks& row, float* __restrict steepest,
                                   uint8_t* __restrict way) {
  std::array<float, kReposeBlock> most{};
  std::array<int32_t, kReposeBlock> best;
  best.fill(kWaysOnMap);
  const float* const top = row.top[1].data() + 1;
  for (int32_t k = 0; k < kForwardLinks; ++k) {
    const auto link = static_cast<size_t>(k);
    consider_row(top,
                 row.top[static_cast<size_t>(1 + kForwardRow[k])].data() + 1 + kForwardColumn[k],
                 row.forward[link].data(), 2 * k, most.data(), best.data());
    consider_row(
        top, row.top[static_cast<size_t>(1 - kForwardRow[k])].data() + 1 - kForwardColumn[k],
        row.back[link].data() + 1 - kForwardColumn[k], 2 * k + 1, most.data(), best.data());
  }
  for (size_t i = 0; i < static_cast<size_t>(kReposeBlock); ++i) {
    steepest[i] = most[i];
    way[i] = static_cast<uint8_t>(best[i]);
  }
}

}  // namespace

CellWays::Block& CellWays::block_of(int32_t cell) {
  auto& block = blocks[static_cast<size_t>(cell / kTileCells)];
  if (block == nullptr) {
    block = std::make_unique_for_overwrite<Block>();
    block->last.fill(kNoCell);
    block->units.fill(0.0);
  }
  return *block;
}

/// The next cell along the steepest link of the snow's surface; -1 - outlet, if it leads over one;
/// the cell itself in a hollow.
int32_t CellWays::next_cell(const ReposeLinks& links, const ReposeBlocks& map, int32_t cell) {
  const int32_t block = cell / kTileCells;
  const int32_t inner = cell % kTileCells;
  const auto own = static_cast<size_t>(inner);
  const int32_t column = inner % kReposeBlock;
  const int32_t row = inner / kReposeBlock;
  const int32_t side = links.blocks_a_side;
  Block& known = block_of(cell);
  if (((known.rows >> static_cast<uint32_t>(row)) & 1) == 0) {
    known.rows |= 1u << static_cast<uint32_t>(row);
    const auto first = static_cast<size_t>(row * kReposeBlock);
    find_ways(RowLinks(TilesAround(map.tiles, side, block), row), &known.steepest[first],
              &known.way[first]);
  }
  const ReposeTile& tile = *map.tiles[static_cast<size_t>(block)];
  const float top = tile.snow.top[own];
  float steepest = known.steepest[own];
  int32_t next = cell;
  if (const int32_t way = known.way[own]; way < kWaysOnMap) {
    const int32_t sign = way % 2 == 0 ? 1 : -1;
    const int32_t x = column + sign * kForwardColumn[way / 2];
    const int32_t y = row + sign * kForwardRow[way / 2];
    const int32_t dx = x < 0 ? -1 : x / kReposeBlock;
    const int32_t dy = y < 0 ? -1 : y / kReposeBlock;
    next = (block + dy * side + dx) * kTileCells + (y & (kReposeBlock - 1)) * kReposeBlock +
           (x & (kReposeBlock - 1));
  }
  const auto consider = [&](float fall, float limit, int32_t to) {
    if (!(limit < kNoLink) || !(fall > steepest * limit)) return;
    steepest = fall / limit;
    next = to;
  };
  const std::vector<OutletLink>& outlet_links = map.outlet_links[static_cast<size_t>(block)];
  const auto is_before = [](const OutletLink& outlet, int32_t at) { return outlet.cell < at; };
  for (auto outlet = std::lower_bound(outlet_links.begin(), outlet_links.end(), inner, is_before);
       outlet != outlet_links.end() && outlet->cell == inner; ++outlet) {
    consider(top - outlet->bare, outlet->limit,
             outlet->number < 0 ? links.cell_of(-1 - outlet->number) : -1 - outlet->number);
  }
  if ((tile.ground.forward[own] & kAtSeam) == 0) return next;
  links.for_across(cell, [&](int32_t to, size_t link) {
    const ReposeTile* const other = map.tiles[static_cast<size_t>(to / kTileCells)].get();
    if (other == nullptr) return;
    consider(top - other->snow.top[static_cast<size_t>(to % kTileCells)],
             map.flows.links[link].limit, to);
  });
  return next;
}

int32_t CellWays::last_in_block(const ReposeLinks& links, const ReposeBlocks& map, int32_t cell) {
  Block& block = block_of(cell);
  const int32_t first = cell / kTileCells * kTileCells;
  const auto last_of = [&](int32_t own) -> int32_t& {
    return block.last[static_cast<size_t>(own - first)];
  };
  block.passed.clear();
  while (last_of(cell) == kNoCell) {
    block.passed.push_back(cell);
    const int32_t next = next_cell(links, map, cell);
    if (next == cell || next < first || next >= first + kTileCells) {
      last_of(cell) = cell;
      break;
    }
    cell = next;
  }
  const int32_t found = last_of(cell);
  for (const int32_t own : block.passed) last_of(own) = found;
  return found;
}

/// -1 - outlet, or the last cell. Surfaces only fall along a way, so that it ends.
int32_t CellWays::end_of(const ReposeLinks& links, const ReposeBlocks& map, int32_t cell) {
  for (;;) {
    cell = last_in_block(links, map, cell);
    const int32_t next = next_cell(links, map, cell);
    if (next < 0 || next == cell) return next;
    cell = next;
  }
}

/// Adds up what was cut from a block's cells, by the last cells of their ways in it. Blocks do not
/// share anything that this changes.
void CellWays::collect_cuts(const ReposeLinks& links, const ReposeBlocks& map, int32_t block) {
  const int32_t first = block * kTileCells;
  Block& own = block_of(first);
  for (const auto& [cell, units] : map.tiles[static_cast<size_t>(block)]->outlets.cuts) {
    const int32_t last = last_in_block(links, map, first + cell);
    double& sum = own.units[static_cast<size_t>(last - first)];
    if (sum == 0.0) own.reached.push_back(last);
    sum += static_cast<double>(units);
  }
}

std::vector<Release> collect_releases(const ReposeGround& ground, const ReposeBlocks& blocks,
                                      const std::vector<int32_t>& chosen, bool on_all_cores) {
  std::vector<Release> releases;
  const auto unit = static_cast<double>(ground.surface.unit());
  const size_t outlet_count = ground.outlet_count();
  std::vector<double> fallen(outlet_count, 0.0);
  std::vector<int32_t> texel(outlet_count, -1);
  CellWays ways;
  ways.blocks.resize(blocks.tiles.size());
  for_each_block(chosen.size(), on_all_cores,
                 [&](size_t i) { ways.collect_cuts(*ground.links, blocks, chosen[i]); });
  // By cell, the units that end there.
  std::map<int32_t, double> ends;
  for (const int32_t block : chosen) {
    for (const OutletLink& outlet : blocks.outlet_links[static_cast<size_t>(block)]) {
      if (outlet.number < 0) {
        if (outlet.fallen > 0.0) ends[ground.links->cell_of(-1 - outlet.number)] += outlet.fallen;
        continue;
      }
      texel[static_cast<size_t>(outlet.number)] = outlet.texel;
      fallen[static_cast<size_t>(outlet.number)] += outlet.fallen;
    }
    const CellWays::Block& own = ways.block_of(block * kTileCells);
    for (const int32_t cell : own.reached) {
      const double units = own.units[static_cast<size_t>(cell % kTileCells)];
      const int32_t end = ways.end_of(*ground.links, blocks, cell);
      (end < 0 ? fallen[static_cast<size_t>(-1 - end)] : ends[end]) += units;
    }
  }
  for (const auto& [end, units] : ends) {
    const int32_t side = ground.links->blocks_a_side;
    const int32_t last = end % kTileCells;
    const int32_t column = end / kTileCells % side * kReposeBlock + last % kReposeBlock;
    const int32_t row = end / kTileCells / side * kReposeBlock + last / kReposeBlock;
    const bool is_wall = blocks.tiles[static_cast<size_t>(end / kTileCells)]->snow.is_wall(
        static_cast<size_t>(last));
    releases.push_back({is_wall ? Release::kOffWall : Release::kInHollow,
                        texel_at(ground.table(), row * ground.links->resolution + column),
                        units * unit});
  }
  for (size_t i = 0; i < fallen.size(); ++i) {
    if (fallen[i] > 0.0) {
      releases.push_back({static_cast<int32_t>(i), texel[i], fallen[i] * unit});
    }
  }
  return releases;
}

}  // namespace snowbough::snow
