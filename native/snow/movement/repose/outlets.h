#pragma once

#include <cstdint>
#include <vector>

#include "snow/movement/repose/ground.h"
#include "snow/movement/repose/link_limits.h"
#include "snow/movement/repose/seam_flows.h"
#include "snow/movement/repose/tile.h"

namespace snowbough::snow {

/// The snow on the blocks of a map while it moves.
struct ReposeBlocks {
  /// Tiles of the chosen blocks during a run (all existing ones during a partial run), by block.
  ReposeTiles tiles;
  /// Tiles that the next step reuses (gain: 37 % of a bake); by block, whether chosen before.
  ReposeTiles stored;
  std::vector<uint8_t> was_chosen;
  /// Outlets by block, ascending by cell.
  std::vector<std::vector<OutletLink>> outlet_links;
  SeamFlows flows;
};

/// The height in metres to which snow stands at either of two places.
float stands(const std::vector<float>& stand, int32_t a, int32_t b);

/// Finds a block's outlets, over which snow leaves the map (open edges, and walls), and
/// the limits of its links across seams. `stand`: by place, the height to which snow stands
/// whatever its slope; null: nowhere.
void set_up_outlets(const ReposeGround& ground, const ReposeLimits& limits,
                    const std::vector<float>* stand, int32_t block, ReposeBlocks& blocks);

/// Whether snow lies on the first cell up the slope from an outlet that is not too steep for it,
/// and is at least as thick as the horizontal way there is long: bevels carry none themselves.
bool is_below_snow(const ReposeGround& ground, const ReposeLimits& limits,
                   const ReposeBlocks& blocks, int32_t block, const OutletLink& outlet);

/// Height in metres of the snow's surface above an outlet.
float top_over(const ReposeBlocks& blocks, int32_t block, const OutletLink& outlet);

}  // namespace snowbough::snow
