#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <optional>
#include <vector>

#include "snow/movement/repose/ground.h"
#include "snow/movement/repose/link_limits.h"
#include "snow/movement/repose/slack.h"

namespace snowbough::snow {

/// The blocks in which snow may move in a step.
struct ReposeChoice {
  ReposeLimits limits;
  /// By block, in the current pose and with these limits, as far as it was needed.
  std::vector<std::optional<BlockSlack>> slack;
  /// By block: the highest snow on it at the start of the step, in metres.
  std::vector<float> highest;
  /// Blocks in which snow may not rest, with their neighbours, ascending.
  std::vector<int32_t> chosen;
  /// By block: whether a blade has pushed snow there; empty: nowhere. And whether only those run.
  std::vector<uint8_t> blades;
  bool is_partial = false;
  /// By block: whether snow may move from it; empty: from all.
  std::vector<uint8_t> within;

  bool may_run(int32_t block) const {
    return within.empty() || within[static_cast<size_t>(block)] != 0;
  }
};

/// A block's texels on the map: the first place, and the numbers of columns and rows.
struct BlockRect {
  size_t place = 0;
  glm::ivec2 size{0};
};
BlockRect rect_of(const ReposeLinks& links, int32_t block);

/// These blocks and their neighbours, ascending.
std::vector<int32_t> near_blocks(const ReposeLinks& links, const std::vector<int32_t>& blocks);

/// The highest snow in a block and its neighbours at the start of the step.
float highest_near(const ReposeLinks& links, const ReposeChoice& choice, int32_t block);

/// Chooses by `height`, signed metres by place, among `choice.within`. `blades`, `only_there`: as
/// in Repose::choose_blocks.
void choose_blocks(const ReposeGround& ground, const std::vector<float>& height,
                   const std::vector<int32_t>& blades, bool only_there, ReposeChoice& choice);

}  // namespace snowbough::snow
