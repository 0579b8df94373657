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
/// Rounds of a part of a step ahead of a blade, and at a time.
constexpr int kBladeRounds = 8;
constexpr int kBladeRoundsAtOnce = 4;
constexpr double kRoundsABlock = 40.0;
constexpr double kRoundsAMap = 24000.0;
/// Duration in seconds of a step with these limits, and the factor for the longest steps.
constexpr float kUsualStep = 0.25f;
constexpr float kMaxWorkFactor = 8.0f;

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

}  // namespace

double Repose::run(std::vector<float>& height, float dt, bool lists_releases) {
  if (choice_.chosen.empty()) return 0.0;
  if (!choice_.is_partial) empty_over_outlets();
  run_rounds(std::clamp(dt / kUsualStep, 1.0f, kMaxWorkFactor));
  const float walls_keep = std::exp2(-dt / shared::kWallHalfLife);
  std::vector<Written> written(choice_.chosen.size());
  for_each(choice_.chosen.size(),
           [&](size_t i) { written[i] = write_block(choice_.chosen[i], walls_keep, height); });
  double fallen = 0.0;
  for (const Written& own : written) {
    fallen += own.lost;
    has_changed_ = has_changed_ || own.has_changed;
  }
  if (lists_releases) {
    releases_ = collect_releases(ground_, blocks_, choice_.chosen, ways_);
    for (const Written& own : written) {
      releases_.insert(releases_.end(), own.releases.begin(), own.releases.end());
    }
  }
  blocks_.tiles.swap(stored_tiles_);
  return fallen * static_cast<double>(ground_.surface.unit());
}

/// Updates a tile's links, if needed.
void Repose::link_tile(int32_t block) {
  if (blocks_.tiles[static_cast<size_t>(block)]->links.has_limits) return;
  set_up_tile_links(blocks_.tiles, block, ground_.links->blocks_a_side, choice_.limits);
  if (stand_ != nullptr) raise_limits(block);
}

/// Raises the limits of a tile's links where snow stands.
void Repose::raise_limits(int32_t block) {
  const BlockRect rect = rect_of(*ground_.links, block);
  const int32_t side = ground_.links->resolution;
  TileLinks& links = blocks_.tiles[static_cast<size_t>(block)]->links;
  for (int32_t row = 0; row < rect.size.y; ++row) {
    for (int32_t column = 0; column < rect.size.x; ++column) {
      const int32_t place = static_cast<int32_t>(rect.place) + row * side + column;
      for (int32_t k = 0; k < kForwardLinks; ++k) {
        float& limit =
            links.limit[static_cast<size_t>(k)][static_cast<size_t>(row * kReposeBlock + column)];
        // Links end on the map.
        if (!(limit < kNoLink)) continue;
        limit = std::max(limit,
                         stands(*stand_, place, place + kForwardRow[k] * side + kForwardColumn[k]));
      }
    }
  }
}

/// The chosen blocks with chosen(block) in every second row and column, starting at the colour's
/// offset: no two of them touch.
template <typename Chosen>
Repose::Blocks Repose::blocks_of_colour(int32_t colour, const Chosen& chosen) const {
  const int32_t side = ground_.links->blocks_a_side;
  Blocks blocks;
  for (const int32_t block : choice_.chosen) {
    const int32_t own = block / side % 2 * 2 + block % side % 2;
    if (own == colour && chosen(block)) blocks.push_back(block);
  }
  return blocks;
}

/// Removes snow above rims and walls that is steeper than allowed.
void Repose::empty_over_outlets() {
  Marks active(ground_.links->block_count(), 0);
  for (const int32_t block : choice_.chosen) active[static_cast<size_t>(block)] = 1;
  const int32_t side = ground_.links->blocks_a_side;
  for (bool continues = true; continues;) {
    continues = false;
    for (int32_t colour = 0; colour < 4; ++colour) {
      const Blocks blocks = blocks_of_colour(
          colour, [&](int32_t block) { return active[static_cast<size_t>(block)] != 0; });
      std::vector<TileBounds> done(blocks.size());
      for_each(blocks.size(), [&](size_t i) {
        link_tile(blocks[i]);
        done[i] = lower_tile_bounds(blocks_.tiles, blocks[i], side,
                                    blocks_.rims[static_cast<size_t>(blocks[i])]);
      });
      for (size_t i = 0; i < blocks.size(); ++i) {
        mark_around(side, blocks[i], done[i].seen_by, active);
        continues = continues || done[i].has_changed;
      }
      for (const int32_t block : blocks) active[static_cast<size_t>(block)] = 0;
    }
    continues =
        lower_across(*ground_.links, blocks_.tiles, choice_.chosen, blocks_.flows, active) ||
        continues;
  }
  Marks cuts(choice_.chosen.size(), 0);
  for_each(choice_.chosen.size(), [&](size_t i) {
    const int32_t block = choice_.chosen[i];
    cuts[i] = choice_.may_run(block) && blocks_.tiles[static_cast<size_t>(block)]->cut() ? 1 : 0;
  });
  has_changed_ =
      has_changed_ || std::any_of(cuts.begin(), cuts.end(), [](uint8_t c) { return c != 0; });
}

/// Runs the rounds of blocks that do not touch each other; returns their number.
double Repose::run_colour(const Blocks& blocks, int first_round, int rounds_at_once) {
  std::vector<TileRounds> done(blocks.size());
  for_each(blocks.size(), [&](size_t i) {
    link_tile(blocks[i]);
    done[i] =
        run_tile_rounds(blocks_.tiles, blocks[i], ground_.links->blocks_a_side,
                        blocks_.rims[static_cast<size_t>(blocks[i])], first_round, rounds_at_once);
  });
  double rounds = 0.0;
  for (size_t i = 0; i < blocks.size(); ++i) {
    const TileRounds& own = done[i];
    if (own.has_changed) note_active(*ground_.links, blocks_.flows, blocks[i]);
    rounds += own.rounds;
    seams_are_pending_ = seams_are_pending_ || own.has_changed;
    has_changed_ = has_changed_ || own.has_changed;
  }
  return rounds;
}

/// Ahead of a blade snow need not rest before the blade does.
bool Repose::runs(int32_t block, int round) const {
  if (!choice_.may_run(block)) return false;
  const bool is_ahead = !choice_.blades.empty() && choice_.blades[static_cast<size_t>(block)] != 0;
  return is_ahead ? round < kBladeRounds : !choice_.is_partial;
}

void Repose::run_rounds(float work_factor) {
  for (SeamFlows::Link& link : blocks_.flows.links) {
    link.flow = 0.0f;
    link.is_listed = false;
  }
  blocks_.flows.listed.clear();
  for (const int32_t block : choice_.chosen) {
    if (runs(block, 0)) note_active(*ground_.links, blocks_.flows, block);
  }
  seams_are_pending_ = true;
  double work = static_cast<double>(work_factor) *
                (kRoundsAMap + kRoundsABlock * static_cast<double>(ground_.links->block_count()));
  const int most = choice_.is_partial
                       ? kBladeRounds
                       : static_cast<int>(static_cast<float>(kMaxRounds) * work_factor);
  int round = 0;
  int round_across = 0;
  int at_once = kRounds;
  for (bool continues = true; continues && round < most && work > 0.0; round += at_once) {
    continues = false;
    at_once = !choice_.blades.empty() && round < kBladeRounds ? kBladeRoundsAtOnce : kRounds;
    for (int32_t i = 0; i < 4; ++i) {
      // Heaps of grains would show which blocks are always first.
      const int32_t colour = choice_.limits.is_granular && round / kRounds % 2 == 1 ? 3 - i : i;
      const Blocks blocks = blocks_of_colour(colour, [&](int32_t block) {
        return runs(block, round) && blocks_.tiles[static_cast<size_t>(block)]->links.is_active();
      });
      if (!blocks.empty()) {
        const double rounds = run_colour(blocks, round, at_once);
        rounds_ += rounds;
        work -= rounds;
        continues = true;
      }
      if (!blocks_.flows.links.empty() && seams_are_pending_) {
        seams_are_pending_ = flow_across(
            *ground_.links, blocks_.tiles, blocks_.flows,
            [&](int32_t block) { return runs(block, 0); }, shared::flow_momentum(round_across++));
        has_changed_ = has_changed_ || seams_are_pending_;
      }
    }
    continues = continues || (!blocks_.flows.links.empty() && seams_are_pending_);
  }
}

/// Writes moved snow. Snow that sticks to walls falls, except the fraction `walls_keep`.
Repose::Written Repose::write_block(int32_t block, float walls_keep,
                                    std::vector<float>& height) const {
  const ReposeTile& tile = *blocks_.tiles[static_cast<size_t>(block)];
  Written written;
  if (!tile.snow.has_moved() && !tile.outlets.any_wall) return written;
  const std::vector<int32_t>& places = ground_.table().texel;
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
      written.lost += melted / ground_.surface.unit();
      own = kept;
      return;
    }
    const double depth =
        static_cast<double>(std::abs(own)) + moved * (static_cast<double>(ground_.surface.unit()) /
                                                      static_cast<double>(tile.ground.area[cell]));
    const auto now = static_cast<float>(std::max(depth, 0.0));
    own = (tile.snow.kind[cell] & kBack) != 0 && now > 0.0f ? -now : now;
    written.lost -= moved;
  };
  ground_.links->for_texels(block, places, write, rows_to_write(tile));
  return written;
}

}  // namespace snowbough::snow
