#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "snow/movement/repose/links.h"
#include "snow/movement/repose/tile.h"

namespace snowbough::snow {

/// Snow that flows across the seams of a map's layout.
struct SeamFlows {
  struct Link {
    float limit = 0.0f;
    float rate = 0.0f;
    float flow = 0.0f;
    /// Whether it is in `listed`.
    bool is_listed = false;
  };
  /// By link across a seam, ReposeLinks::across.
  std::vector<Link> links;
  /// Those to evaluate; between rounds, those along which snow flows.
  std::vector<int32_t> listed;
  /// Blocks whose surfaces at seams may have changed since the last round, and a flag per block.
  std::vector<int32_t> noted;
  std::vector<uint8_t> is_noted;
};

/// Passes new bounds on across seams; activates the blocks in which any changed, one flag each.
bool lower_across(const ReposeLinks& links, const ReposeTiles& tiles,
                  const std::vector<int32_t>& chosen, SeamFlows& flows,
                  std::vector<uint8_t>& active);

/// Records that surfaces of a block, or of its neighbours, may have changed since the last round
/// across seams.
void note_active(const ReposeLinks& links, SeamFlows& flows, int32_t block);

/// A round of flows across seams of blocks with runs(block). Returns whether any snow flows.
bool flow_across(const ReposeLinks& links, const ReposeTiles& tiles, SeamFlows& flows,
                 const std::function<bool(int32_t)>& runs, float momentum);

}  // namespace snowbough::snow
