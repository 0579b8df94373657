#include "snow/movement/repose/repose.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/simd.h"
#include "shaders/lib/texel_repose.h"
#include "snow/movement/repose/tiles_around.h"

namespace snowbough::snow {
namespace {

/// Rounds of a block at a time: with more, a heap over many blocks takes longer to rest.
constexpr int kRounds = 8;
/// Work limits of a step, in rounds of one block: per block of the map, and per map.
constexpr int kMaxRounds = 800;
constexpr double kRoundsABlock = 40.0;
constexpr double kRoundsAMap = 24000.0;
/// Duration in seconds of a step with these limits, and the factor for the longest steps.
constexpr float kUsualStep = 0.25f;
constexpr float kMaxWorkFactor = 8.0f;
/// Rounds ahead of a blade: in a part of a step, and of a block at a time.
constexpr int kBladeRounds = 8;
constexpr int kBladeRoundsAtOnce = 4;

/// Rows of a tile in which snow has moved or sticks to walls, one bit each.
SNOWBOUGH_WIDE uint32_t rows_to_write(const ReposeTile& tile) {
  uint32_t rows = tile.snow.moved_rows.load(std::memory_order_relaxed);
  for (int32_t row = 0; tile.outlets.any_wall && row < kReposeBlock; ++row) {
    const size_t first = static_cast<size_t>(row * kReposeBlock);
    const float* const held = tile.snow.held.data() + first;
    const uint8_t* const kind = tile.snow.kind.data() + first;
    int32_t any = 0;
    for (int32_t i = 0; i < kReposeBlock; ++i) any |= (held[i] != 0.0f ? 1 : 0) & kind[i];
    rows |= static_cast<uint32_t>(any & kWall) << static_cast<uint32_t>(row);
  }
  return rows;
}

/// A run of the chosen blocks, and what it has found so far.
struct ReposeRun {
  const ReposeGround& ground;
  const ReposeChoice& choice;
  ReposeBlocks& blocks;
  const std::vector<float>* stand;
  bool on_all_cores;
  /// Whether snow may flow across seams.
  bool seams_are_pending = false;
  bool has_changed = false;
  double rounds = 0.0;

  template <typename Work>
  void for_each(size_t count, const Work& work) const {
    for_each_block(count, on_all_cores, work);
  }
};

/// Result of writing a block: units that left the surface (fell over open edges, onto walls or off
/// them), and whether heights changed.
struct Written {
  double lost = 0.0;
  bool has_changed = false;
  /// From walls.
  std::vector<Release> releases;
};

/// Raises the limits of a tile's links where snow stands.
void raise_limits(ReposeRun& run, int32_t block) {
  const BlockRect rect = rect_of(*run.ground.links, block);
  const int32_t side = run.ground.links->resolution;
  TileLinks& links = run.blocks.tiles[static_cast<size_t>(block)]->links;
  for (int32_t row = 0; row < rect.size.y; ++row) {
    for (int32_t column = 0; column < rect.size.x; ++column) {
      const int32_t place = static_cast<int32_t>(rect.place) + row * side + column;
      for (int32_t k = 0; k < kForwardLinks; ++k) {
        float& limit =
            links.limit[static_cast<size_t>(k)][static_cast<size_t>(row * kReposeBlock + column)];
        // Links end on the map.
        if (!(limit < kNoLink)) continue;
        limit = std::max(
            limit, stands(*run.stand, place, place + kForwardRow[k] * side + kForwardColumn[k]));
      }
    }
  }
}

/// Updates a tile's links, if needed.
void link_tile(ReposeRun& run, int32_t block) {
  if (run.blocks.tiles[static_cast<size_t>(block)]->links.has_limits) return;
  set_up_tile_links(run.blocks.tiles, block, run.ground.links->blocks_a_side, run.choice.limits);
  if (run.stand != nullptr) raise_limits(run, block);
}

/// The chosen blocks with chosen(block) in every second row and column, starting at the colour's
/// offset: no two of them touch.
template <typename Chosen>
std::vector<int32_t> blocks_of_colour(const ReposeRun& run, int32_t colour, const Chosen& chosen) {
  const int32_t side = run.ground.links->blocks_a_side;
  std::vector<int32_t> blocks;
  for (const int32_t block : run.choice.chosen) {
    const int32_t own = block / side % 2 * 2 + block % side % 2;
    if (own == colour && chosen(block)) blocks.push_back(block);
  }
  return blocks;
}

/// Removes snow above open edges and walls that is steeper than allowed.
void empty_over_outlets(ReposeRun& run) {
  std::vector<uint8_t> active(run.ground.links->block_count(), 0);
  for (const int32_t block : run.choice.chosen) active[static_cast<size_t>(block)] = 1;
  const int32_t side = run.ground.links->blocks_a_side;
  for (bool continues = true; continues;) {
    continues = false;
    for (int32_t colour = 0; colour < 4; ++colour) {
      const std::vector<int32_t> blocks = blocks_of_colour(
          run, colour, [&](int32_t block) { return active[static_cast<size_t>(block)] != 0; });
      std::vector<TileBounds> done(blocks.size());
      run.for_each(blocks.size(), [&](size_t i) {
        link_tile(run, blocks[i]);
        done[i] = lower_tile_bounds(run.blocks.tiles, blocks[i], side,
                                    run.blocks.outlet_links[static_cast<size_t>(blocks[i])]);
      });
      for (size_t i = 0; i < blocks.size(); ++i) {
        mark_around(side, blocks[i], done[i].seen_by, active);
        continues = continues || done[i].has_changed;
      }
      for (const int32_t block : blocks) active[static_cast<size_t>(block)] = 0;
    }
    continues = lower_across(*run.ground.links, run.blocks.tiles, run.choice.chosen,
                             run.blocks.flows, active) ||
                continues;
  }
  std::vector<uint8_t> cuts(run.choice.chosen.size(), 0);
  run.for_each(run.choice.chosen.size(), [&](size_t i) {
    const int32_t block = run.choice.chosen[i];
    cuts[i] =
        run.choice.may_run(block) && run.blocks.tiles[static_cast<size_t>(block)]->cut() ? 1 : 0;
  });
  run.has_changed =
      run.has_changed || std::any_of(cuts.begin(), cuts.end(), [](uint8_t c) { return c != 0; });
}

/// Runs the rounds of blocks that do not touch each other; returns their number.
double run_colour(ReposeRun& run, const std::vector<int32_t>& blocks, int first_round,
                  int rounds_at_once) {
  std::vector<TileRounds> done(blocks.size());
  run.for_each(blocks.size(), [&](size_t i) {
    link_tile(run, blocks[i]);
    done[i] = run_tile_rounds(run.blocks.tiles, blocks[i], run.ground.links->blocks_a_side,
                              run.blocks.outlet_links[static_cast<size_t>(blocks[i])], first_round,
                              rounds_at_once);
  });
  double rounds = 0.0;
  for (size_t i = 0; i < blocks.size(); ++i) {
    const TileRounds& own = done[i];
    if (own.has_changed) note_active(*run.ground.links, run.blocks.flows, blocks[i]);
    rounds += own.rounds;
    run.seams_are_pending = run.seams_are_pending || own.has_changed;
    run.has_changed = run.has_changed || own.has_changed;
  }
  return rounds;
}

/// Ahead of a blade snow need not rest before the blade does.
bool runs(const ReposeChoice& choice, int32_t block, int round) {
  if (!choice.may_run(block)) return false;
  const bool is_ahead = !choice.blades.empty() && choice.blades[static_cast<size_t>(block)] != 0;
  return is_ahead ? round < kBladeRounds : !choice.is_partial;
}

void run_rounds(ReposeRun& run, float work_factor) {
  for (SeamFlows::Link& link : run.blocks.flows.links) {
    link.flow = 0.0f;
    link.is_listed = false;
  }
  run.blocks.flows.listed.clear();
  for (const int32_t block : run.choice.chosen) {
    if (runs(run.choice, block, 0)) note_active(*run.ground.links, run.blocks.flows, block);
  }
  run.seams_are_pending = true;
  double work =
      static_cast<double>(work_factor) *
      (kRoundsAMap + kRoundsABlock * static_cast<double>(run.ground.links->block_count()));
  const int most = run.choice.is_partial
                       ? kBladeRounds
                       : static_cast<int>(static_cast<float>(kMaxRounds) * work_factor);
  int round = 0;
  int round_across = 0;
  int at_once = kRounds;
  for (bool continues = true; continues && round < most && work > 0.0; round += at_once) {
    continues = false;
    at_once = !run.choice.blades.empty() && round < kBladeRounds ? kBladeRoundsAtOnce : kRounds;
    for (int32_t i = 0; i < 4; ++i) {
      // Heaps of grains would show which blocks are always first.
      const int32_t colour = run.choice.limits.is_granular && round / kRounds % 2 == 1 ? 3 - i : i;
      const std::vector<int32_t> blocks = blocks_of_colour(run, colour, [&](int32_t block) {
        return runs(run.choice, block, round) &&
               run.blocks.tiles[static_cast<size_t>(block)]->links.is_active();
      });
      if (!blocks.empty()) {
        const double rounds = run_colour(run, blocks, round, at_once);
        run.rounds += rounds;
        work -= rounds;
        continues = true;
      }
      if (!run.blocks.flows.links.empty() && run.seams_are_pending) {
        run.seams_are_pending = flow_across(
            *run.ground.links, run.blocks.tiles, run.blocks.flows,
            [&](int32_t block) { return runs(run.choice, block, 0); },
            shared::flow_momentum(round_across++));
        run.has_changed = run.has_changed || run.seams_are_pending;
      }
    }
    continues = continues || (!run.blocks.flows.links.empty() && run.seams_are_pending);
  }
}

/// Writes moved snow. Snow that sticks to walls falls, except the fraction `walls_keep`.
Written write_block(const ReposeRun& run, int32_t block, float walls_keep,
                    std::vector<float>& height) {
  const ReposeTile& tile = *run.blocks.tiles[static_cast<size_t>(block)];
  Written written;
  if (!tile.snow.has_moved() && !tile.outlets.any_wall) return written;
  const std::vector<int32_t>& places = run.ground.table().texel;
  const auto write = [&](int32_t texel, size_t cell) {
    const bool wall = (tile.snow.kind[cell] & kWall) != 0;
    const double moved = tile.snow.moved[cell];
    if (wall ? tile.snow.held[cell] == 0.0f : moved == 0.0) return;
    written.has_changed = true;
    float& own = height[static_cast<size_t>(places[static_cast<size_t>(texel)])];
    if (wall) {
      const float left = std::abs(own) * walls_keep;
      const float kept = left < shared::kWallLeast ? 0.0f : std::copysign(left, own);
      const double melted =
          static_cast<double>(std::abs(own) - std::abs(kept)) * tile.ground.area[cell];
      if (melted > 0.0) written.releases.push_back({Release::kOffWall, texel, melted});
      written.lost += melted / run.ground.surface.unit();
      own = kept;
      return;
    }
    const double depth = static_cast<double>(std::abs(own)) +
                         moved * (static_cast<double>(run.ground.surface.unit()) /
                                  static_cast<double>(tile.ground.area[cell]));
    const auto now = static_cast<float>(std::max(depth, 0.0));
    own = (tile.snow.kind[cell] & kBack) != 0 && now > 0.0f ? -now : now;
    written.lost -= moved;
  };
  run.ground.links->for_texels(block, places, write, rows_to_write(tile));
  return written;
}

}  // namespace

ReposeResult Repose::run(std::vector<float>& height, float dt, bool on_all_cores,
                         bool lists_releases) {
  ReposeResult result;
  if (choice_.chosen.empty()) return result;
  ReposeRun run{ground_, choice_, blocks_, stand_.height, on_all_cores};
  if (!choice_.is_partial) empty_over_outlets(run);
  run_rounds(run, std::clamp(dt / kUsualStep, 1.0f, kMaxWorkFactor));
  const float walls_keep = std::exp2(-dt / shared::kWallHalfLife);
  std::vector<Written> written(choice_.chosen.size());
  run.for_each(choice_.chosen.size(), [&](size_t i) {
    written[i] = write_block(run, choice_.chosen[i], walls_keep, height);
  });
  result.rounds = run.rounds;
  result.has_changed = run.has_changed;
  double fallen = 0.0;
  for (const Written& own : written) {
    fallen += own.lost;
    result.has_changed = result.has_changed || own.has_changed;
  }
  result.fallen = fallen * static_cast<double>(ground_.surface.unit());
  if (lists_releases) {
    result.releases = collect_releases(ground_, blocks_, choice_.chosen, on_all_cores);
    for (const Written& own : written) {
      result.releases.insert(result.releases.end(), own.releases.begin(), own.releases.end());
    }
  }
  blocks_.tiles.swap(blocks_.stored);
  return result;
}

}  // namespace snowbough::snow
