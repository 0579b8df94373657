#include "snow/movement/repose/seam_flows.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "shaders/lib/texel_repose.h"
#include "snow/movement/repose/tiles_around.h"

namespace snowbough::snow {
namespace {

/// A cell of an existing tile, or none.
struct End {
  ReposeTile* tile = nullptr;
  size_t cell = 0;
};

End end_of(const ReposeTiles& tiles, int32_t cell) {
  return {tiles[static_cast<size_t>(cell / kTileCells)].get(),
          static_cast<size_t>(cell % kTileCells)};
}

/// Calls visit(end, link, own cell, the other end's cell) for the ends of links across seams in a
/// block.
template <typename Visit>
void for_across(const ReposeLinks& links, SeamFlows& flows, int32_t block, const Visit& visit) {
  const int32_t* ends = &links.end_begin[static_cast<size_t>(block)];
  for (int32_t e = ends[0]; e < ends[1]; ++e) {
    const ReposeLinks::End& end = links.ends[static_cast<size_t>(e)];
    const auto link = static_cast<size_t>(end.link);
    if (link >= links.across.size()) continue;
    SeamFlows::Link& flow = flows.links[link];
    if (!(flow.limit < std::numeric_limits<float>::infinity())) continue;
    const auto& [a, b] = links.across_cells[link];
    visit(end, flow, end.cell, end.sign < 0 ? b : a);
  }
}

/// Lists the links across seams to evaluate: those with a changed surface at one end, and those
/// with flow in the previous round.
void list_active_links(const ReposeLinks& links, const ReposeTiles& tiles, SeamFlows& flows,
                       const std::function<bool(int32_t)>& runs) {
  for (const int32_t block : flows.noted) {
    flows.is_noted[static_cast<size_t>(block)] = 0;
    ReposeTile* const tile = tiles[static_cast<size_t>(block)].get();
    if (tile == nullptr || !runs(block)) continue;
    const uint32_t rows = tile->links.active_rows_at_seams.exchange(0, std::memory_order_relaxed);
    if (rows == 0) continue;
    const int32_t* ends = &links.end_begin[static_cast<size_t>(block)];
    for (int32_t e = ends[0]; e < ends[1]; ++e) {
      const ReposeLinks::End& end = links.ends[static_cast<size_t>(e)];
      const auto link = static_cast<size_t>(end.link);
      const auto row = static_cast<uint32_t>(end.cell % kTileCells / kReposeBlock);
      if (((rows >> row) & 1) == 0 || link >= links.across.size()) continue;
      SeamFlows::Link& flow = flows.links[link];
      if (flow.is_listed || !(flow.limit < std::numeric_limits<float>::infinity())) continue;
      flow.is_listed = true;
      flows.listed.push_back(end.link);
    }
  }
  flows.noted.clear();
}

/// Computes the flow along a link; returns whether there is any.
bool flow_along(const ReposeLinks& links, const ReposeTiles& tiles, SeamFlows& flows,
                int32_t number, float momentum) {
  SeamFlows::Link& link = flows.links[static_cast<size_t>(number)];
  const auto& [at_a, at_b] = links.across_cells[static_cast<size_t>(number)];
  const End a = end_of(tiles, at_a);
  const End b = end_of(tiles, at_b);
  if (a.tile == nullptr || b.tile == nullptr) return false;
  const float fall = a.tile->snow.top[a.cell] - b.tile->snow.top[b.cell];
  if (link.flow == 0.0f && !(std::abs(fall) > link.limit)) return false;
  const float wanted = shared::wanted_flow(link.flow, fall, link.limit, link.rate, momentum);
  // An equal part for every link: the demands of the others are not known here.
  const auto part = [&](const End& giver) {
    const float own_part = 1.0f / static_cast<float>(giver.tile->ground.link_count[giver.cell]);
    return shared::given_part(giver.tile->snow.gives[giver.cell] * own_part, std::abs(wanted));
  };
  link.flow = wanted == 0.0f ? 0.0f : shared::given_flow(wanted, part(a), part(b));
  return link.flow != 0.0f;
}

}  // namespace

bool lower_across(const ReposeLinks& links, const ReposeTiles& tiles,
                  const std::vector<int32_t>& chosen, SeamFlows& flows,
                  std::vector<uint8_t>& active) {
  bool changes = false;
  for (const int32_t block : chosen) {
    ReposeTile& tile = *tiles[static_cast<size_t>(block)];
    if (!tile.outlets.has_fresh_bounds.exchange(false, std::memory_order_relaxed)) continue;
    for_across(
        links, flows, block,
        [&](const ReposeLinks::End&, const SeamFlows::Link& link, int32_t own, int32_t other) {
          const auto a = static_cast<size_t>(own % kTileCells);
          const End to = end_of(tiles, other);
          if (to.tile == nullptr) return;
          const float over = std::max(
              shared::passed_bound(tile.outlets.bound[a], tile.snow.top[a], tile.ground.z[a]) +
                  shared::kCuts * link.limit,
              to.tile->ground.z[to.cell]);
          if (!(over < to.tile->outlets.bound[to.cell])) return;
          to.tile->outlets.bound[to.cell] = over;
          to.tile->outlets.has_bounds = true;
          const float passed =
              shared::passed_bound(over, to.tile->snow.top[to.cell], to.tile->ground.z[to.cell]);
          if (!(passed < shared::kUnbounded)) return;
          to.tile->outlets.has_fresh_bounds = true;
          const auto cell = static_cast<int32_t>(to.cell);
          const int32_t block_of_other = other / kTileCells;
          active[static_cast<size_t>(block_of_other)] = 1;
          const int32_t column = cell % kReposeBlock;
          const int32_t row = cell / kReposeBlock;
          mark_around(links.blocks_a_side, block_of_other, TileWindow::seen_by(column, row),
                      active);
          note_bound(TilesAround(tiles, links.blocks_a_side, block_of_other), column, row);
          changes = true;
        });
  }
  return changes;
}

void note_active(const ReposeLinks& links, SeamFlows& flows, int32_t block) {
  const int32_t side = links.blocks_a_side;
  const int32_t column = block % side;
  const int32_t row = block / side;
  for (int32_t y = std::max(0, row - 1); y <= std::min(side - 1, row + 1); ++y) {
    for (int32_t x = std::max(0, column - 1); x <= std::min(side - 1, column + 1); ++x) {
      uint8_t& noted = flows.is_noted[static_cast<size_t>(y * side + x)];
      if (noted == 0) flows.noted.push_back(y * side + x);
      noted = 1;
    }
  }
}

bool flow_across(const ReposeLinks& links, const ReposeTiles& tiles, SeamFlows& flows,
                 const std::function<bool(int32_t)>& runs, float momentum) {
  list_active_links(links, tiles, flows, runs);
  // Computes all flows before applying any.
  std::erase_if(flows.listed, [&](int32_t link) {
    flows.links[static_cast<size_t>(link)].is_listed =
        flow_along(links, tiles, flows, link, momentum);
    return !flows.links[static_cast<size_t>(link)].is_listed;
  });
  const int32_t side = links.blocks_a_side;
  for (const int32_t link : flows.listed) {
    const float flow = flows.links[static_cast<size_t>(link)].flow;
    const auto& [at_a, at_b] = links.across_cells[static_cast<size_t>(link)];
    for (const auto& [at, units] : {std::pair(at_a, -flow), std::pair(at_b, flow)}) {
      const int32_t block = at / kTileCells;
      const int32_t cell = at % kTileCells;
      tiles[static_cast<size_t>(block)]->add(static_cast<size_t>(cell), static_cast<double>(units));
      activate_cell(TilesAround(tiles, side, block), cell % kReposeBlock, cell / kReposeBlock);
      note_active(links, flows, block);
    }
  }
  return !flows.listed.empty();
}

}  // namespace snowbough::snow
