#include "snow/movement/repose/releases.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "shaders/lib/texel_repose.h"
#include "snow/movement/rays/map_point.h"

namespace snowbough::snow {
namespace {

constexpr int32_t kNoWay = std::numeric_limits<int32_t>::min();

/// The next cell along the steepest link of the snow's surface; -1 - outlet, if it leads over one;
/// the cell itself in a hollow. Cells are numbered as by ReposeLinks::cell_of.
int32_t next_cell(const ReposeLinks& links, const ReposeBlocks& blocks, int32_t cell) {
  const int32_t block = cell / kTileCells;
  const int32_t inner = cell % kTileCells;
  const ReposeTile& tile = *blocks.tiles[static_cast<size_t>(block)];
  const auto own = static_cast<size_t>(inner);
  const float top = tile.snow.top[own];
  float steepest = 0.0f;
  int32_t next = cell;
  // Limits grow with the distance, so their ratio with the fall ranks slopes.
  const auto consider = [&](float fall, float limit, int32_t to) {
    if (!(limit < kNoLink) || !(fall > steepest * limit)) return;
    steepest = fall / limit;
    next = to;
  };
  const int32_t column = inner % kReposeBlock;
  const int32_t row = inner / kReposeBlock;
  const int32_t side = links.blocks_a_side;
  for (int32_t k = 0; k < kForwardLinks; ++k) {
    for (const int32_t sign : {1, -1}) {
      const int32_t x = column + sign * kForwardColumn[k];
      const int32_t y = row + sign * kForwardRow[k];
      const ReposeTile* other = &tile;
      int32_t other_block = block;
      if (((x | y) & ~(kReposeBlock - 1)) != 0) {
        const int32_t dx = x < 0 ? -1 : x / kReposeBlock;
        const int32_t dy = y < 0 ? -1 : y / kReposeBlock;
        const int32_t beside = block % side + dx;
        other_block = block + dy * side + dx;
        if (beside < 0 || beside >= side || other_block < 0 || other_block >= side * side) continue;
        other = blocks.tiles[static_cast<size_t>(other_block)].get();
        if (other == nullptr) continue;
      }
      const int32_t at = (y & (kReposeBlock - 1)) * kReposeBlock + (x & (kReposeBlock - 1));
      const ReposeTile& giver = sign > 0 ? tile : *other;
      if (!giver.links.has_limits) continue;
      consider(top - other->snow.top[static_cast<size_t>(at)],
               giver.links.limit[static_cast<size_t>(k)][sign > 0 ? own : static_cast<size_t>(at)],
               other_block * kTileCells + at);
    }
  }
  const std::vector<RimLink>& rims = blocks.rims[static_cast<size_t>(block)];
  const auto is_before = [](const RimLink& rim, int32_t at) { return rim.cell < at; };
  for (auto rim = std::lower_bound(rims.begin(), rims.end(), inner, is_before);
       rim != rims.end() && rim->cell == inner; ++rim) {
    consider(top - rim->bare, rim->limit,
             rim->number < 0 ? links.cell_of(-1 - rim->number) : -1 - rim->number);
  }
  if ((tile.ground.forward[own] & kAtSeam) == 0) return next;
  links.for_across(cell, [&](int32_t to, size_t link) {
    const ReposeTile* const other = blocks.tiles[static_cast<size_t>(to / kTileCells)].get();
    if (other == nullptr) return;
    consider(top - other->snow.top[static_cast<size_t>(to % kTileCells)],
             blocks.flows.links[link].limit, to);
  });
  return next;
}

}  // namespace

CellWays::Block& CellWays::block_of(int32_t cell) {
  auto& block = blocks[static_cast<size_t>(cell / kTileCells)];
  if (block == nullptr) block = std::make_unique_for_overwrite<Block>();
  if (std::exchange(block->run, run) != run) {
    block->end.fill(kNoWay);
    block->units.fill(0.0);
  }
  return *block;
}

void CellWays::begin(size_t count) {
  ++run;
  blocks.resize(count);
  ends.clear();
}

/// -1 - outlet, or the last cell. Surfaces only fall along a way, so that it ends.
int32_t CellWays::find(const ReposeLinks& links, const ReposeBlocks& blocks, int32_t cell) {
  const auto end_of = [&](int32_t own) -> int32_t& {
    return block_of(own).end[static_cast<size_t>(own % kTileCells)];
  };
  passed.clear();
  while (end_of(cell) == kNoWay) {
    passed.push_back(cell);
    const int32_t next = next_cell(links, blocks, cell);
    if (next < 0 || next == cell) {
      end_of(cell) = next;
      break;
    }
    cell = next;
  }
  const int32_t found = end_of(cell);
  for (const int32_t own : passed) end_of(own) = found;
  return found;
}

void CellWays::add(int32_t end, double units) {
  double& sum = block_of(end).units[static_cast<size_t>(end % kTileCells)];
  if (sum == 0.0) ends.push_back(end);
  sum += units;
}

std::vector<Release> collect_releases(const ReposeGround& ground, const ReposeBlocks& blocks,
                                      const std::vector<int32_t>& chosen, CellWays& ways) {
  std::vector<Release> releases;
  const auto unit = static_cast<double>(ground.surface.unit());
  const size_t outlet_count = ground.outlet_count();
  std::vector<double> fallen(outlet_count, 0.0);
  std::vector<int32_t> texel(outlet_count, -1);
  ways.begin(blocks.tiles.size());
  for (const int32_t block : chosen) {
    for (const RimLink& rim : blocks.rims[static_cast<size_t>(block)]) {
      if (rim.number < 0) {
        if (rim.fallen > 0.0) ways.add(ground.links->cell_of(-1 - rim.number), rim.fallen);
        continue;
      }
      texel[static_cast<size_t>(rim.number)] = rim.texel;
      fallen[static_cast<size_t>(rim.number)] += rim.fallen;
    }
  }
  for (const int32_t block : chosen) {
    for (const auto& [cell, units] : blocks.tiles[static_cast<size_t>(block)]->outlets.cuts) {
      const int32_t end = ways.find(*ground.links, blocks, block * kTileCells + cell);
      if (end < 0) {
        fallen[static_cast<size_t>(-1 - end)] += static_cast<double>(units);
      } else {
        ways.add(end, static_cast<double>(units));
      }
    }
  }
  for (const int32_t end : ways.ends) {
    const int32_t side = ground.links->blocks_a_side;
    const int32_t last = end % kTileCells;
    const int32_t column = end / kTileCells % side * kReposeBlock + last % kReposeBlock;
    const int32_t row = end / kTileCells / side * kReposeBlock + last / kReposeBlock;
    const bool is_wall = blocks.tiles[static_cast<size_t>(end / kTileCells)]->snow.is_wall(
        static_cast<size_t>(last));
    releases.push_back({is_wall ? Release::kOffWall : Release::kInHollow,
                        texel_at(ground.table(), row * ground.links->resolution + column),
                        ways.block_of(end).units[static_cast<size_t>(last)] * unit});
  }
  for (size_t i = 0; i < fallen.size(); ++i) {
    if (fallen[i] > 0.0) {
      releases.push_back({static_cast<int32_t>(i), texel[i], fallen[i] * unit});
    }
  }
  return releases;
}

}  // namespace snowbough::snow
