#include "snow/repose/repose.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "base/parallel_for.h"
#include "shaders/lib/texel_repose.h"

namespace snowbough::snow {
namespace {

constexpr float kNoLink = std::numeric_limits<float>::infinity();
/// A step goes on for at most so many rounds, and for so much work, in rounds of one block: for
/// every block of the map, and for any map.
constexpr int kMostRounds = 400;
constexpr double kRoundsABlock = 10.0;
constexpr double kRoundsAMap = 3000.0;

}  // namespace

void Repose::for_blocks(const std::vector<int32_t>& blocks, const Work& work) const {
  if (on_all_cores_) {
    base::for_each_item(blocks.size(), 1, [&](size_t i) { work(blocks[i]); });
  } else {
    for (const int32_t block : blocks) work(block);
  }
}

void Repose::take_pose() {
  if (links_.resolution == 0) {
    const std::vector<glm::vec3>& rest = object_->description.rest;
    links_ = find_repose_links(object_->description.topology, object_->table,
                               rest.empty() ? object_->positions : rest);
    is_chosen_.assign(links_.block_count(), 0);
    const size_t ends = links_.across.size() + links_.rims.size();
    for (std::vector<float>* values : {&end_limit_, &end_rate_, &end_flow_}) {
      values->assign(ends, 0.0f);
    }
    rim_top_.assign(links_.rims.size(), 0.0f);
  }
  surface_.set_pose(*object_);
  slack_.assign(links_.block_count(), {});
  has_pose_ = true;
}

Repose::Range Repose::range_of(int32_t block, const std::vector<float>& height) const {
  const int32_t left = block % links_.blocks_a_side;
  const int32_t first_row = block / links_.blocks_a_side * kReposeBlock;
  Range range{kNoLink, 0.0f};
  for (int32_t row = first_row; row < std::min(first_row + kReposeBlock, links_.resolution);
       ++row) {
    const int32_t* run = &links_.run_begin[static_cast<size_t>(row * links_.blocks_a_side + left)];
    for (int32_t i = run[0]; i < run[1]; ++i) {
      const size_t place = static_cast<size_t>(object_->table.texel[static_cast<size_t>(i)]);
      const float depth = std::abs(height[place]);
      range.low = std::min(range.low, depth);
      range.high = std::max(range.high, depth);
    }
  }
  return range;
}

/// Whether no link of the block can be over its limit. Two points that lie as far apart as bare and
/// whose heights differ by at most `span` and their normals by `turn`, fall by at most span +
/// high * turn more and come nearer by as much.
bool Repose::is_level(int32_t block, const std::vector<Range>& ranges) const {
  Range range{kNoLink, 0.0f};
  const auto b = static_cast<size_t>(block);
  for (int32_t n = links_.near_begin[b]; n < links_.near_begin[b + 1]; ++n) {
    const Range& other = ranges[static_cast<size_t>(links_.near[static_cast<size_t>(n)])];
    range = {std::min(range.low, other.low), std::max(range.high, other.high)};
  }
  if (range.high <= 0.0f) return true;
  const BlockSlack& slack = slack_[b];
  const float lifted = range.high - range.low + range.high * slack.turn;
  return slack.is_known && (1.0f + slope_) * lifted <= slack.inside &&
         (1.0f + slope_) * range.high <= slack.at_edges;
}

std::vector<int32_t> Repose::near(const std::vector<int32_t>& blocks,
                                  const std::vector<uint8_t>* only) const {
  std::vector<int32_t> result;
  for (const int32_t block : blocks) {
    const auto b = static_cast<size_t>(block);
    for (int32_t n = links_.near_begin[b]; n < links_.near_begin[b + 1]; ++n) {
      const int32_t other = links_.near[static_cast<size_t>(n)];
      if (only == nullptr || (*only)[static_cast<size_t>(other)] != 0) result.push_back(other);
    }
  }
  std::sort(result.begin(), result.end());
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

size_t Repose::choose_blocks(const std::vector<float>& height, float slope) {
  changed_.clear();
  chosen_.clear();
  if (!has_pose_) {
    const bool is_bare = std::all_of(height.begin(), height.end(), [](float h) { return h == 0; });
    if (is_bare) return 0;
    take_pose();
  }
  if (slope != slope_) slack_.assign(slack_.size(), {});
  slope_ = slope;
  std::vector<Range> ranges(links_.block_count());
  for (size_t b = 0; b < ranges.size(); ++b) {
    ranges[b] = range_of(static_cast<int32_t>(b), height);
  }
  doubtful_.clear();
  for (size_t b = 0; b < ranges.size(); ++b) {
    if (!is_level(static_cast<int32_t>(b), ranges)) doubtful_.push_back(static_cast<int32_t>(b));
  }
  chosen_ = near(doubtful_, nullptr);
  return chosen_.size();
}

double Repose::run(std::vector<float>& height, float patience, ReposeField& field,
                   bool on_all_cores) {
  if (chosen_.empty()) return 0.0;
  on_all_cores_ = on_all_cores;
  for (const int32_t block : chosen_) is_chosen_[static_cast<size_t>(block)] = 1;
  for_blocks(chosen_, [&](int32_t b) {
    surface_.fill_block(links_, b, height, field);
    raise_tops(b, field);
  });
  for (size_t r = 0; r < links_.rims.size(); ++r) {
    rim_top_[r] = surface_.point(links_.rims[r].triangle, links_.rims[r].weights).z;
  }
  std::vector<uint8_t> steep(links_.block_count(), 0);
  for_blocks(chosen_, [&](int32_t b) {
    steep[static_cast<size_t>(b)] = set_up_block(b, field) ? 1 : 0;
  });
  // What is known of a block holds only where all that it is linked with was looked at.
  for (const int32_t block : near(doubtful_, nullptr)) {
    slack_[static_cast<size_t>(block)].is_known = false;
  }
  for (const int32_t block : doubtful_) slack_[static_cast<size_t>(block)].is_known = true;

  std::vector<int32_t> awake;
  for (const int32_t block : chosen_) {
    if (steep[static_cast<size_t>(block)] != 0) awake.push_back(block);
  }
  double fallen = 0.0;
  if (!awake.empty()) {
    run_rounds(std::move(awake), patience, field);
    std::vector<double> parts(links_.block_count(), 0.0);
    for_blocks(chosen_, [&](int32_t b) {
      parts[static_cast<size_t>(b)] = write_block(b, height, field);
    });
    for (const int32_t block : chosen_) fallen += parts[static_cast<size_t>(block)];
  }
  for_blocks(chosen_, [&](int32_t b) { clear_block(b, field); });
  for (const int32_t block : chosen_) is_chosen_[static_cast<size_t>(block)] = 0;
  return fallen * static_cast<double>(surface_.unit());
}

void Repose::run_rounds(std::vector<int32_t> awake, float patience, ReposeField& field) {
  std::fill(end_flow_.begin(), end_flow_.end(), 0.0f);
  std::vector<uint8_t> flows(links_.block_count(), 0);
  std::vector<uint8_t> moves(links_.block_count(), 0);
  std::vector<uint8_t> has_changed(links_.block_count(), 0);
  const auto marked = [](const std::vector<int32_t>& blocks, const std::vector<uint8_t>& marks) {
    std::vector<int32_t> result;
    for (const int32_t block : blocks) {
      if (marks[static_cast<size_t>(block)] != 0) result.push_back(block);
    }
    return result;
  };
  double work = static_cast<double>(patience) *
                (kRoundsAMap + kRoundsABlock * static_cast<double>(links_.block_count()));
  const int most = static_cast<int>(static_cast<float>(kMostRounds) * patience);
  for (int round = 0; round < most && !awake.empty() && work > 0.0; ++round) {
    work -= static_cast<double>(awake.size());
    const float momentum = shared::flow_momentum(round);
    for_blocks(awake, [&](int32_t b) {
      flows[static_cast<size_t>(b)] = flow_block(b, momentum, field) ? 1 : 0;
    });
    std::vector<int32_t> stirred = marked(awake, flows);
    const std::vector<int32_t> reached = near(stirred, &is_chosen_);
    for_blocks(reached, [&](int32_t b) {
      moves[static_cast<size_t>(b)] = move_block(b, field) ? 1 : 0;
      if (moves[static_cast<size_t>(b)] != 0) has_changed[static_cast<size_t>(b)] = 1;
    });
    const std::vector<int32_t> moved = marked(reached, moves);
    stirred.insert(stirred.end(), moved.begin(), moved.end());
    awake = near(stirred, &is_chosen_);
  }
  changed_ = marked(chosen_, has_changed);
}

}  // namespace snowbough::snow
