#include "snow/repose/repose.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "shaders/lib/texel_repose.h"

namespace snowbough::snow {
namespace {

/// Rounds that a block does at a time.
constexpr int kRounds = 16;
/// A step goes on for at most so many rounds, and for so much work, in rounds of one block: for
/// every block of the map, and for any map.
constexpr int kMostRounds = 400;
constexpr double kRoundsABlock = 40.0;
constexpr double kRoundsAMap = 12000.0;
/// Seconds of a step that is granted so much, and how much longer the longest may go on.
constexpr float kUsualStep = 0.25f;
constexpr float kMostPatience = 8.0f;

}  // namespace

void Repose::mark_near(int32_t block, Marks& marks) const {
  const auto b = static_cast<size_t>(block);
  for (int32_t n = links_.near_begin[b]; n < links_.near_begin[b + 1]; ++n) {
    marks[static_cast<size_t>(links_.near[static_cast<size_t>(n)])] = 1;
  }
}

/// Those blocks and the blocks near them, ascending.
Repose::Blocks Repose::near(const Blocks& blocks) const {
  Marks marks(links_.block_count(), 0);
  for (const int32_t block : blocks) mark_near(block, marks);
  Blocks result;
  for (size_t b = 0; b < marks.size(); ++b) {
    if (marks[b] != 0) result.push_back(static_cast<int32_t>(b));
  }
  return result;
}

double Repose::run(std::vector<float>& height, float dt, bool on_all_cores) {
  if (chosen_.empty()) return 0.0;
  on_all_cores_ = on_all_cores;
  set_up(height);
  empty_over_outlets();
  run_rounds(doubtful_, std::clamp(dt / kUsualStep, 1.0f, kMostPatience));
  has_changed_ = has_changed_ || std::any_of(chosen_.begin(), chosen_.end(),
                                             [&](int32_t block) { return walls_hold_snow(block); });
  const float walls_keep = std::exp2(-dt / shared::kWallHalfLife);
  double fallen = 0.0;
  std::vector<double> parts(has_changed_ ? links_.block_count() : 0, 0.0);
  if (has_changed_) {
    for_blocks(chosen_, [&](int32_t b) {
      parts[static_cast<size_t>(b)] = write_block(b, walls_keep, height);
    });
    for (const int32_t block : chosen_) fallen += parts[static_cast<size_t>(block)];
  }
  for (const int32_t block : chosen_) {
    kept_[static_cast<size_t>(block)] = std::move(tiles_[static_cast<size_t>(block)]);
  }
  return fallen * static_cast<double>(surface_.unit());
}

/// Brings a tile's links up to date. Those of tiles to which nothing comes are not asked for.
void Repose::link_tile(int32_t block) {
  if (tiles_[static_cast<size_t>(block)]->has_links) return;
  set_up_tile_links(tiles_, block, links_.blocks_a_side, slope_);
}

/// Those of the chosen blocks that are awake and in every second row and column, from the colour's
/// on: no two of them touch.
Repose::Blocks Repose::awake_of_colour(const Marks& awake, int32_t colour) const {
  const int32_t side = links_.blocks_a_side;
  Blocks blocks;
  for (const int32_t block : chosen_) {
    const int32_t own = block / side % 2 * 2 + block % side % 2;
    if (own == colour && awake[static_cast<size_t>(block)] != 0) blocks.push_back(block);
  }
  return blocks;
}

/// Lowers bounds across seams; wakes the blocks in which any changed.
bool Repose::lower_across(Marks& awake) {
  bool changes = false;
  const auto lower = [&](int32_t from_cell, int32_t to_cell, float limit) {
    const ReposeTile& from = *tiles_[static_cast<size_t>(from_cell / kTileCells)];
    ReposeTile& to = *tiles_[static_cast<size_t>(to_cell / kTileCells)];
    const auto a = static_cast<size_t>(from_cell % kTileCells);
    const auto b = static_cast<size_t>(to_cell % kTileCells);
    const float over =
        shared::passed_bound(from.bound[a], from.top[a], from.z[a]) + shared::kCuts * limit;
    if (!(over < to.bound[b])) return;
    to.bound[b] = over;
    mark_near(to_cell / kTileCells, awake);
    changes = true;
  };
  for (size_t link = 0; link < across_.size(); ++link) {
    const auto& [a, b] = links_.across_cells[link];
    const bool is_open = tiles_[static_cast<size_t>(a / kTileCells)] != nullptr &&
                         tiles_[static_cast<size_t>(b / kTileCells)] != nullptr &&
                         across_[link].limit < std::numeric_limits<float>::infinity();
    if (!is_open) continue;
    lower(a, b, across_[link].limit);
    lower(b, a, across_[link].limit);
  }
  return changes;
}

/// What lies higher over rims and walls than the slope allows falls at once.
void Repose::empty_over_outlets() {
  Marks awake(links_.block_count(), 0);
  for (const int32_t block : doubtful_) awake[static_cast<size_t>(block)] = 1;
  const int32_t side = links_.blocks_a_side;
  for (bool goes_on = true; goes_on;) {
    goes_on = false;
    for (int32_t colour = 0; colour < 4; ++colour) {
      const Blocks blocks = awake_of_colour(awake, colour);
      std::vector<TileBounds> done(links_.block_count());
      for_blocks(blocks, [&](int32_t block) {
        link_tile(block);
        done[static_cast<size_t>(block)] =
            lower_tile_bounds(tiles_, block, side, rims_[static_cast<size_t>(block)]);
      });
      for (const int32_t block : blocks) {
        if (done[static_cast<size_t>(block)].border_has_changed) mark_near(block, awake);
        goes_on = goes_on || done[static_cast<size_t>(block)].has_changed;
      }
      for (const int32_t block : blocks) awake[static_cast<size_t>(block)] = 0;
    }
    goes_on = lower_across(awake) || goes_on;
  }
  Marks cuts(links_.block_count(), 0);
  for_blocks(chosen_, [&](int32_t block) {
    cuts[static_cast<size_t>(block)] = tiles_[static_cast<size_t>(block)]->cut() ? 1 : 0;
  });
  has_changed_ =
      has_changed_ || std::any_of(cuts.begin(), cuts.end(), [](uint8_t c) { return c != 0; });
}

/// Lets blocks that do not touch each other do their rounds; marks those to which snow goes on, in
/// `seams` also those whose links across seams it may concern. Returns the rounds that were done.
double Repose::run_colour(const Blocks& blocks, int first_round, Marks& awake, Marks& seams) {
  std::vector<TileRounds> done(blocks.size());
  Blocks order(blocks.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int32_t>(i);
  for_blocks(order, [&](int32_t i) {
    const int32_t block = blocks[static_cast<size_t>(i)];
    std::vector<RimLink>& rims = rims_[static_cast<size_t>(block)];
    link_tile(block);
    // Most blocks are at rest: to see it takes less than a round.
    uint8_t& rests = rests_[static_cast<size_t>(block)];
    if (rests != 0 && is_at_rest(tiles_, block, links_.blocks_a_side, rims)) return;
    TileRounds& own = done[static_cast<size_t>(i)];
    own = run_tile_rounds(tiles_, block, links_.blocks_a_side, rims, first_round, kRounds);
    rests = own.flows ? 0 : 1;
  });
  double rounds = 0.0;
  for (size_t i = 0; i < blocks.size(); ++i) {
    const auto block = static_cast<size_t>(blocks[i]);
    rounds += done[i].rounds;
    if (done[i].border_has_changed) mark_near(blocks[i], awake);
    awake[block] = done[i].flows ? 1 : 0;
    has_changed_ = has_changed_ || done[i].has_changed;
    if (done[i].has_changed) mark_near(blocks[i], seams);
  }
  return rounds;
}

/// A round of flows across the seams of the marked blocks.
void Repose::flow_across(float momentum, Marks& awake, Marks& seams) {
  Blocks blocks;
  for (size_t b = 0; b < seams.size(); ++b) {
    if (seams[b] != 0 && tiles_[b] != nullptr && links_.end_begin[b] != links_.end_begin[b + 1]) {
      blocks.push_back(static_cast<int32_t>(b));
    }
    seams[b] = 0;
  }
  Marks flows(seams.size(), 0);
  const auto ends_of = [&](int32_t block, const auto& visit) {
    const int32_t* ends = &links_.end_begin[static_cast<size_t>(block)];
    for (int32_t e = ends[0]; e < ends[1]; ++e) {
      const ReposeLinks::End& end = links_.ends[static_cast<size_t>(e)];
      if (static_cast<size_t>(end.link) < across_.size()) visit(end);
    }
  };
  for_blocks(blocks, [&](int32_t block) {
    ends_of(block, [&](const ReposeLinks::End& end) {
      Flow& link = across_[static_cast<size_t>(end.link)];
      if (end.sign > 0 || !(link.limit < std::numeric_limits<float>::infinity())) return;
      const auto& [cell_a, cell_b] = links_.across_cells[static_cast<size_t>(end.link)];
      const ReposeTile& a = *tiles_[static_cast<size_t>(cell_a / kTileCells)];
      const ReposeTile& b = *tiles_[static_cast<size_t>(cell_b / kTileCells)];
      const auto at_a = static_cast<size_t>(cell_a % kTileCells);
      const auto at_b = static_cast<size_t>(cell_b % kTileCells);
      const float wanted = shared::wanted_flow(link.flow, a.top[at_a] - b.top[at_b], link.limit,
                                               link.rate, momentum);
      // An equal part for every link: the others are not known here.
      link.flow = shared::given_flow(
          wanted, shared::given_part(a.gives[at_a] * a.part[at_a], std::abs(wanted)),
          shared::given_part(b.gives[at_b] * b.part[at_b], std::abs(wanted)));
      if (link.flow != 0.0f) flows[static_cast<size_t>(block)] = 1;
    });
  });
  Blocks flowing;
  for (const int32_t block : blocks) {
    if (flows[static_cast<size_t>(block)] != 0) flowing.push_back(block);
  }
  for (const int32_t block : flowing) seams[static_cast<size_t>(block)] = 1;
  Blocks reached;
  for (const int32_t block : near(flowing)) {
    if (tiles_[static_cast<size_t>(block)] != nullptr) reached.push_back(block);
  }
  Marks moves(seams.size(), 0);
  for_blocks(reached, [&](int32_t block) {
    ReposeTile& tile = *tiles_[static_cast<size_t>(block)];
    ends_of(block, [&](const ReposeLinks::End& end) {
      const float flow = across_[static_cast<size_t>(end.link)].flow;
      if (flow == 0.0f) return;
      const auto cell = static_cast<size_t>(end.cell % kTileCells);
      tile.moved[cell] += static_cast<double>(static_cast<float>(end.sign) * flow);
      tile.raise(cell);
      moves[static_cast<size_t>(block)] = 1;
    });
  });
  for (const int32_t block : reached) {
    if (moves[static_cast<size_t>(block)] == 0) continue;
    has_changed_ = true;
    mark_near(block, awake);
    mark_near(block, seams);
  }
}

void Repose::run_rounds(const Blocks& doubtful, float patience) {
  Marks awake(links_.block_count(), 0);
  for (const int32_t block : doubtful) awake[static_cast<size_t>(block)] = 1;
  Marks seams = awake;
  rests_.assign(links_.block_count(), 1);
  for (Flow& link : across_) link.flow = 0.0f;
  const auto any = [](const Marks& marks) {
    return std::any_of(marks.begin(), marks.end(), [](uint8_t mark) { return mark != 0; });
  };
  double work = static_cast<double>(patience) *
                (kRoundsAMap + kRoundsABlock * static_cast<double>(links_.block_count()));
  const int most = static_cast<int>(static_cast<float>(kMostRounds) * patience);
  int round = 0;
  int round_across = 0;
  for (bool goes_on = true; goes_on && round < most && work > 0.0; round += kRounds) {
    goes_on = false;
    for (int32_t colour = 0; colour < 4; ++colour) {
      const Blocks blocks = awake_of_colour(awake, colour);
      if (!blocks.empty()) {
        work -= run_colour(blocks, round, awake, seams);
        goes_on = true;
      }
      if (!across_.empty() && any(seams)) {
        flow_across(shared::flow_momentum(round_across++), awake, seams);
      }
    }
    goes_on = goes_on || (!across_.empty() && any(seams));
  }
}

/// Stability takes snow off what is a wall by its smooth normals; here the faces' own count, and
/// between the two of them snow would stay for ever.
bool Repose::walls_hold_snow(int32_t block) const {
  const ReposeTile& tile = *tiles_[static_cast<size_t>(block)];
  bool any = false;
  links_.for_texels(block, object_->table.texel, [&](int32_t, size_t cell) {
    any = any || ((tile.kind[cell] & kWall) != 0 && tile.held[cell] > 0.0f);
  });
  return any;
}

/// `walls_keep`: the part of their snow. Returns the units that left the surface: they fell over
/// rims, onto walls or off them.
double Repose::write_block(int32_t block, float walls_keep, std::vector<float>& height) const {
  const ReposeTile& tile = *tiles_[static_cast<size_t>(block)];
  const std::vector<int32_t>& places = object_->table.texel;
  double lost = 0.0;
  links_.for_texels(block, places, [&](int32_t texel, size_t cell) {
    float& own = height[static_cast<size_t>(places[static_cast<size_t>(texel)])];
    const double moved = tile.moved[cell];
    if ((tile.kind[cell] & kWall) != 0) {
      const float left = std::abs(own) * walls_keep;
      const float kept = left < shared::kWallLeast ? 0.0f : std::copysign(left, own);
      lost +=
          static_cast<double>(std::abs(own) - std::abs(kept)) * tile.area[cell] / surface_.unit();
      own = kept;
      return;
    }
    if (moved == 0.0) return;
    const double depth =
        static_cast<double>(std::abs(own)) +
        moved * (static_cast<double>(surface_.unit()) / static_cast<double>(tile.area[cell]));
    const auto now = static_cast<float>(std::max(depth, 0.0));
    own = (tile.kind[cell] & kBack) != 0 && now > 0.0f ? -now : now;
    lost -= moved;
  });
  return lost;
}

}  // namespace snowbough::snow
