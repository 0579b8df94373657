#include "snow/movement/repose/choice.h"

#include <algorithm>

#include "base/parallel_for.h"
#include "snow/movement/repose/height_range.h"

namespace snowbough::snow {
namespace {

float highest_in(const ReposeLinks& links, int32_t block, const std::vector<float>& height) {
  const BlockRect rect = rect_of(links, block);
  return highest_of(&height[rect.place], static_cast<size_t>(links.resolution), rect.size);
}

const BlockSlack& slack_of(const ReposeGround& ground, int32_t block, ReposeChoice& choice) {
  std::optional<BlockSlack>& slack = choice.slack[static_cast<size_t>(block)];
  if (!slack)
    slack = find_slack(ground.surface, *ground.links, ground.table().texel, block, choice.limits);
  return *slack;
}

/// Whether it is certain that no link of a block exceeds its limit.
bool rests(const ReposeGround& ground, int32_t block, const std::vector<float>& height,
           ReposeChoice& choice) {
  const auto b = static_cast<size_t>(block);
  const int32_t* const near = &ground.links->near_begin[b];
  const bool is_bare =
      std::all_of(ground.links->near.begin() + near[0], ground.links->near.begin() + near[1],
                  [&](int32_t n) { return choice.highest[static_cast<size_t>(n)] == 0.0f; });
  if (is_bare) return true;
  const float own = choice.highest[b];
  // Snow too high to be level needs no closer examination.
  if (own > 0.0f && !slack_of(ground, block, choice).is_level(own, 0.0f)) return false;
  const HeightRange range =
      find_height_range(*ground.links, ground.table().texel, block, height.data());
  if (range.high == 0.0f) return true;
  const BlockSlack& slack = slack_of(ground, block, choice);
  if (slack.side > 0.0f ? range.any_back : range.any_positive) return false;
  return slack.is_level(range.high, range.step);
}

}  // namespace

BlockRect rect_of(const ReposeLinks& links, int32_t block) {
  const int32_t size = links.resolution;
  const int32_t left = block % links.blocks_a_side * kReposeBlock;
  const int32_t first = block / links.blocks_a_side * kReposeBlock;
  return {static_cast<size_t>(first) * static_cast<size_t>(size) + static_cast<size_t>(left),
          {std::min(kReposeBlock, size - left), std::min(kReposeBlock, size - first)}};
}

std::vector<int32_t> near_blocks(const ReposeLinks& links, const std::vector<int32_t>& blocks) {
  std::vector<uint8_t> marks(links.block_count(), 0);
  for (const int32_t block : blocks) {
    const auto b = static_cast<size_t>(block);
    for (int32_t n = links.near_begin[b]; n < links.near_begin[b + 1]; ++n) {
      marks[static_cast<size_t>(links.near[static_cast<size_t>(n)])] = 1;
    }
  }
  std::vector<int32_t> result;
  for (size_t b = 0; b < marks.size(); ++b) {
    if (marks[b] != 0) result.push_back(static_cast<int32_t>(b));
  }
  return result;
}

float highest_near(const ReposeLinks& links, const ReposeChoice& choice, int32_t block) {
  float highest = 0.0f;
  const int32_t* const near = &links.near_begin[static_cast<size_t>(block)];
  for (int32_t n = near[0]; n < near[1]; ++n) {
    highest =
        std::max(highest, choice.highest[static_cast<size_t>(links.near[static_cast<size_t>(n)])]);
  }
  return highest;
}

void choose_blocks(const ReposeGround& ground, const std::vector<float>& height,
                   const std::vector<int32_t>& blades, bool only_there, ReposeChoice& choice) {
  choice.is_partial = only_there;
  if (!blades.empty()) choice.blades.assign(ground.links->block_count(), 0);
  for (const int32_t block : blades) choice.blades[static_cast<size_t>(block)] = 1;
  if (choice.is_partial) {
    choice.chosen = near_blocks(*ground.links, blades);
    std::fill(choice.highest.begin(), choice.highest.end(), 0.0f);
    for (const int32_t block : choice.chosen) {
      choice.highest[static_cast<size_t>(block)] = highest_in(*ground.links, block, height);
    }
    return;
  }
  const bool everywhere = choice.within.empty();
  std::vector<int32_t> within;
  if (!everywhere) {
    for (size_t b = 0; b < choice.within.size(); ++b) {
      if (choice.within[b] != 0) within.push_back(static_cast<int32_t>(b));
    }
    // As far as the neighbours of chosen blocks.
    within = near_blocks(*ground.links, near_blocks(*ground.links, within));
    std::fill(choice.highest.begin(), choice.highest.end(), 0.0f);
  }
  base::for_each_item(everywhere ? ground.links->block_count() : within.size(), 64, [&](size_t i) {
    const int32_t block = everywhere ? static_cast<int32_t>(i) : within[i];
    choice.highest[static_cast<size_t>(block)] = highest_in(*ground.links, block, height);
  });
  std::vector<uint8_t> are_doubtful(ground.links->block_count(), 0);
  base::for_each_item(ground.links->block_count(), 16, [&](size_t b) {
    const auto block = static_cast<int32_t>(b);
    are_doubtful[b] = !choice.may_run(block) || rests(ground, block, height, choice) ? 0 : 1;
  });
  std::vector<int32_t> doubtful;
  for (size_t b = 0; b < ground.links->block_count(); ++b) {
    if (are_doubtful[b] != 0) doubtful.push_back(static_cast<int32_t>(b));
  }
  choice.chosen = near_blocks(*ground.links, doubtful);
}

}  // namespace snowbough::snow
