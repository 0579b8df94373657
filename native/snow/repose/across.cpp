// What repose does across the seams of a map's layout.
#include <cmath>
#include <limits>

#include "shaders/lib/texel_repose.h"
#include "snow/repose/repose.h"
#include "snow/repose/window.h"

namespace snowbough::snow {
namespace {

/// A cell of a tile that there is, or none.
struct End {
  ReposeTile* tile = nullptr;
  size_t cell = 0;

  /// Whether a surface in its row has changed since the last round across seams.
  bool is_stirred() const {
    return ((tile->stirred_at_seams.load(std::memory_order_relaxed) >> (cell / kReposeBlock)) &
            1) != 0;
  }
};

End end_of(const ReposeTiles& tiles, int32_t cell) {
  return {tiles[static_cast<size_t>(cell / kTileCells)].get(),
          static_cast<size_t>(cell % kTileCells)};
}

}  // namespace

/// Calls visit(end, link, own cell, the other end's cell) for the links across seams that end in a
/// block.
template <typename Visit>
void Repose::for_across(int32_t block, const Visit& visit) {
  const int32_t* ends = &links_.end_begin[static_cast<size_t>(block)];
  for (int32_t e = ends[0]; e < ends[1]; ++e) {
    const ReposeLinks::End& end = links_.ends[static_cast<size_t>(e)];
    const auto link = static_cast<size_t>(end.link);
    if (link >= across_.size()) continue;
    Flow& flow = across_[link];
    if (!(flow.limit < std::numeric_limits<float>::infinity())) continue;
    const auto& [a, b] = links_.across_cells[link];
    visit(end, flow, end.cell, end.sign < 0 ? b : a);
  }
}

/// Passes bounds that are new on across seams; wakes the blocks in which any changed.
bool Repose::lower_across(Marks& awake) {
  bool changes = false;
  for (const int32_t block : chosen_) {
    ReposeTile& tile = *tiles_[static_cast<size_t>(block)];
    if (!tile.has_fresh_bounds.exchange(false, std::memory_order_relaxed)) continue;
    for_across(block, [&](const ReposeLinks::End&, const Flow& link, int32_t own, int32_t other) {
      const auto a = static_cast<size_t>(own % kTileCells);
      const End to = end_of(tiles_, other);
      if (to.tile == nullptr) return;
      const float over =
          shared::passed_bound(tile.bound[a], tile.top[a], tile.z[a]) + shared::kCuts * link.limit;
      if (!(over < to.tile->bound[to.cell])) return;
      to.tile->bound[to.cell] = over;
      to.tile->has_bounds = to.tile->has_fresh_bounds = true;
      mark_near(other / kTileCells, awake);
      changes = true;
    });
  }
  return changes;
}

/// Of the chosen blocks, those with links across seams along which snow flowed in the round before,
/// or may flow since a surface at one of their ends has changed.
Repose::Blocks Repose::stirred_at_seams() {
  Marks marks(links_.block_count(), 0);
  for (const int32_t block : chosen_) {
    const auto b = static_cast<size_t>(block);
    if (flows_across_[b] != 0) marks[b] = 1;
    if (tiles_[b]->stirred_at_seams != 0) mark_near(block, marks);
  }
  Blocks result;
  for (const int32_t block : chosen_) {
    const auto b = static_cast<size_t>(block);
    if (marks[b] != 0 && links_.end_begin[b] != links_.end_begin[b + 1]) result.push_back(block);
  }
  return result;
}

/// A round of flows across seams. Returns whether any snow flows.
bool Repose::flow_across(float momentum) {
  const Blocks blocks = stirred_at_seams();
  for_blocks(blocks, [&](int32_t block) {
    uint8_t& flows = flows_across_[static_cast<size_t>(block)];
    flows = 0;
    for_across(block, [&](const ReposeLinks::End& end, Flow& link, int32_t own, int32_t other) {
      if (end.sign > 0) return;
      const End a = end_of(tiles_, own);
      const End b = end_of(tiles_, other);
      if (link.flow == 0.0f && !a.is_stirred() && !b.is_stirred()) return;
      const float fall = a.tile->top[a.cell] - b.tile->top[b.cell];
      if (link.flow == 0.0f && !(std::abs(fall) > link.limit)) return;
      const float wanted = shared::wanted_flow(link.flow, fall, link.limit, link.rate, momentum);
      // An equal part for every link: the others are not known here.
      const auto part = [&](const End& giver) {
        const float own_part = 1.0f / static_cast<float>(giver.tile->links[giver.cell]);
        return shared::given_part(giver.tile->gives[giver.cell] * own_part, std::abs(wanted));
      };
      link.flow = wanted == 0.0f ? 0.0f : shared::given_flow(wanted, part(a), part(b));
      if (link.flow != 0.0f) flows = 1;
    });
  });
  Blocks flowing;
  for (const int32_t block : blocks) {
    tiles_[static_cast<size_t>(block)]->stirred_at_seams = 0;
    if (flows_across_[static_cast<size_t>(block)] != 0) flowing.push_back(block);
  }
  if (flowing.empty()) return false;
  Blocks reached;
  for (const int32_t block : near(flowing)) {
    if (tiles_[static_cast<size_t>(block)] != nullptr) reached.push_back(block);
  }
  const int32_t side = links_.blocks_a_side;
  for_blocks(reached, [&](int32_t block) {
    ReposeTile& tile = *tiles_[static_cast<size_t>(block)];
    const TilesAround around(tiles_, side, block);
    for_across(block, [&](const ReposeLinks::End& end, const Flow& link, int32_t own, int32_t) {
      if (link.flow == 0.0f) return;
      const auto cell = static_cast<size_t>(own % kTileCells);
      tile.add(cell, static_cast<double>(static_cast<float>(end.sign) * link.flow));
      stir_cell(around, static_cast<int32_t>(cell) % kReposeBlock,
                static_cast<int32_t>(cell) / kReposeBlock);
    });
  });
  has_changed_ = true;
  return true;
}

}  // namespace snowbough::snow
