#include "snow/movement/repose/repose.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/simd.h"
#include "shaders/lib/texel_repose.h"

namespace snowbough::snow {
namespace {

/// Rounds of a block at a time: with more, a heap over many blocks takes longer to rest.
constexpr int kRounds = 8;
/// Work limits of a step, in rounds of one block: per block of the map, and per map.
constexpr int kMostRounds = 800;
/// Rounds of a part of a step ahead of a blade, and at a time.
constexpr int kBladeRounds = 8;
constexpr int kBladeRoundsAtOnce = 4;
constexpr double kRoundsABlock = 40.0;
constexpr double kRoundsAMap = 24000.0;
/// Duration in seconds of a step with these limits, and the factor for the longest steps.
constexpr float kUsualStep = 0.25f;
constexpr float kMostWorkFactor = 8.0f;

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

void Repose::mark_near(int32_t block, Marks& marks) const {
  const auto b = static_cast<size_t>(block);
  for (int32_t n = links_->near_begin[b]; n < links_->near_begin[b + 1]; ++n) {
    marks[static_cast<size_t>(links_->near[static_cast<size_t>(n)])] = 1;
  }
}

/// Marks the blocks around one whose bit is set in `around`: see TileWindow::seen_by.
void Repose::mark_around(int32_t block, uint32_t around, Marks& marks) const {
  const int32_t side = links_->blocks_a_side;
  for (; around != 0; around &= around - 1) {
    const int32_t bit = std::countr_zero(around);
    const int32_t column = block % side + bit % 3 - 1;
    const int32_t row = block / side + bit / 3 - 1;
    if (column < 0 || column >= side || row < 0 || row >= side) continue;
    marks[static_cast<size_t>(row * side + column)] = 1;
  }
}

/// These blocks and their neighbours, ascending.
Repose::Blocks Repose::near(const Blocks& blocks) const {
  Marks marks(links_->block_count(), 0);
  for (const int32_t block : blocks) mark_near(block, marks);
  Blocks result;
  for (size_t b = 0; b < marks.size(); ++b) {
    if (marks[b] != 0) result.push_back(static_cast<int32_t>(b));
  }
  return result;
}

double Repose::run(std::vector<float>& height, float dt, bool lists_releases) {
  if (chosen_.empty()) return 0.0;
  if (!is_partial_) empty_over_outlets();
  run_rounds(std::clamp(dt / kUsualStep, 1.0f, kMostWorkFactor));
  const float walls_keep = std::exp2(-dt / shared::kWallHalfLife);
  std::vector<Written> written(chosen_.size());
  for_each(chosen_.size(),
           [&](size_t i) { written[i] = write_block(chosen_[i], walls_keep, height); });
  double fallen = 0.0;
  for (const Written& own : written) {
    fallen += own.lost;
    has_changed_ = has_changed_ || own.has_changed;
  }
  if (lists_releases) collect_releases(written);
  tiles_.swap(stored_tiles_);
  return fallen * static_cast<double>(surface_.unit());
}

/// Updates a tile's links, if needed.
void Repose::link_tile(int32_t block) {
  if (tiles_[static_cast<size_t>(block)]->links.has_limits) return;
  set_up_tile_links(tiles_, block, links_->blocks_a_side, limits_);
  if (stand_ != nullptr) raise_limits(block);
}

/// The height to which snow stands at either of two places.
float Repose::stands(int32_t a, int32_t b) const {
  return std::max((*stand_)[static_cast<size_t>(a)], (*stand_)[static_cast<size_t>(b)]);
}

/// Raises the limits of a tile's links where snow stands.
void Repose::raise_limits(int32_t block) {
  const BlockRect rect = rect_of(block);
  const int32_t side = links_->resolution;
  TileLinks& links = tiles_[static_cast<size_t>(block)]->links;
  for (int32_t row = 0; row < rect.size.y; ++row) {
    for (int32_t column = 0; column < rect.size.x; ++column) {
      const int32_t place = static_cast<int32_t>(rect.place) + row * side + column;
      for (int32_t k = 0; k < kForwardLinks; ++k) {
        float& limit =
            links.limit[static_cast<size_t>(k)][static_cast<size_t>(row * kReposeBlock + column)];
        // Links end on the map.
        if (!(limit < kNoLink)) continue;
        limit = std::max(limit, stands(place, place + kForwardRow[k] * side + kForwardColumn[k]));
      }
    }
  }
}

/// The chosen blocks with chosen(block) in every second row and column, starting at the colour's
/// offset: no two of them touch.
template <typename Chosen>
Repose::Blocks Repose::blocks_of_colour(int32_t colour, const Chosen& chosen) const {
  const int32_t side = links_->blocks_a_side;
  Blocks blocks;
  for (const int32_t block : chosen_) {
    const int32_t own = block / side % 2 * 2 + block % side % 2;
    if (own == colour && chosen(block)) blocks.push_back(block);
  }
  return blocks;
}

/// Removes snow above rims and walls that is steeper than allowed.
void Repose::empty_over_outlets() {
  Marks active(links_->block_count(), 0);
  for (const int32_t block : chosen_) active[static_cast<size_t>(block)] = 1;
  const int32_t side = links_->blocks_a_side;
  for (bool continues = true; continues;) {
    continues = false;
    for (int32_t colour = 0; colour < 4; ++colour) {
      const Blocks blocks = blocks_of_colour(
          colour, [&](int32_t block) { return active[static_cast<size_t>(block)] != 0; });
      std::vector<TileBounds> done(blocks.size());
      for_each(blocks.size(), [&](size_t i) {
        link_tile(blocks[i]);
        done[i] = lower_tile_bounds(tiles_, blocks[i], side, rims_[static_cast<size_t>(blocks[i])]);
      });
      for (size_t i = 0; i < blocks.size(); ++i) {
        mark_around(blocks[i], done[i].seen_by, active);
        continues = continues || done[i].has_changed;
      }
      for (const int32_t block : blocks) active[static_cast<size_t>(block)] = 0;
    }
    continues = lower_across(active) || continues;
  }
  Marks cuts(chosen_.size(), 0);
  for_each(chosen_.size(),
           [&](size_t i) { cuts[i] = tiles_[static_cast<size_t>(chosen_[i])]->cut() ? 1 : 0; });
  has_changed_ =
      has_changed_ || std::any_of(cuts.begin(), cuts.end(), [](uint8_t c) { return c != 0; });
}

/// Runs the rounds of blocks that do not touch each other; returns their number.
double Repose::run_colour(const Blocks& blocks, int first_round, int rounds_at_once) {
  std::vector<TileRounds> done(blocks.size());
  for_each(blocks.size(), [&](size_t i) {
    link_tile(blocks[i]);
    done[i] = run_tile_rounds(tiles_, blocks[i], links_->blocks_a_side,
                              rims_[static_cast<size_t>(blocks[i])], first_round, rounds_at_once);
  });
  double rounds = 0.0;
  for (size_t i = 0; i < blocks.size(); ++i) {
    const TileRounds& own = done[i];
    if (own.has_changed) note_active(blocks[i]);
    rounds += own.rounds;
    seams_are_pending_ = seams_are_pending_ || own.has_changed;
    has_changed_ = has_changed_ || own.has_changed;
  }
  return rounds;
}

/// Ahead of a blade snow need not rest before the blade does.
bool Repose::runs(int32_t block, int round) const {
  const bool is_ahead = !blades_.empty() && blades_[static_cast<size_t>(block)] != 0;
  return is_ahead ? round < kBladeRounds : !is_partial_;
}

void Repose::run_rounds(float work_factor) {
  for (Flow& link : across_) {
    link.flow = 0.0f;
    link.is_listed = false;
  }
  listed_.clear();
  for (const int32_t block : chosen_) {
    if (runs(block, 0)) note_active(block);
  }
  seams_are_pending_ = true;
  double work = static_cast<double>(work_factor) *
                (kRoundsAMap + kRoundsABlock * static_cast<double>(links_->block_count()));
  const int most =
      is_partial_ ? kBladeRounds : static_cast<int>(static_cast<float>(kMostRounds) * work_factor);
  int round = 0;
  int round_across = 0;
  int at_once = kRounds;
  for (bool continues = true; continues && round < most && work > 0.0; round += at_once) {
    continues = false;
    at_once = !blades_.empty() && round < kBladeRounds ? kBladeRoundsAtOnce : kRounds;
    for (int32_t i = 0; i < 4; ++i) {
      // Heaps of grains would show which blocks are always first.
      const int32_t colour = limits_.is_granular && round / kRounds % 2 == 1 ? 3 - i : i;
      const Blocks blocks = blocks_of_colour(colour, [&](int32_t block) {
        return runs(block, round) && tiles_[static_cast<size_t>(block)]->links.is_active();
      });
      if (!blocks.empty()) {
        const double rounds = run_colour(blocks, round, at_once);
        rounds_ += rounds;
        work -= rounds;
        continues = true;
      }
      if (!across_.empty() && seams_are_pending_) {
        seams_are_pending_ = flow_across(shared::flow_momentum(round_across++));
      }
    }
    continues = continues || (!across_.empty() && seams_are_pending_);
  }
}

/// Writes moved snow. Snow that sticks to walls falls, except the fraction `walls_keep`.
Repose::Written Repose::write_block(int32_t block, float walls_keep,
                                    std::vector<float>& height) const {
  const ReposeTile& tile = *tiles_[static_cast<size_t>(block)];
  Written written;
  if (!tile.snow.has_moved() && !tile.outlets.any_wall) return written;
  const std::vector<int32_t>& places = table().texel;
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
      written.lost += melted / surface_.unit();
      own = kept;
      return;
    }
    const double depth =
        static_cast<double>(std::abs(own)) + moved * (static_cast<double>(surface_.unit()) /
                                                      static_cast<double>(tile.ground.area[cell]));
    const auto now = static_cast<float>(std::max(depth, 0.0));
    own = (tile.snow.kind[cell] & kBack) != 0 && now > 0.0f ? -now : now;
    written.lost -= moved;
  };
  links_->for_texels(block, places, write, rows_to_write(tile));
  return written;
}

}  // namespace snowbough::snow
