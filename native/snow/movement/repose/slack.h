#pragma once

#include <cstdint>
#include <vector>

#include "snow/movement/repose/link_limits.h"
#include "snow/movement/repose/links.h"
#include "snow/movement/repose/surface.h"

namespace snowbough::snow {

/// Bounds of a block's links on the bare surface of a pose, in metres. They show that snow rests
/// without setting up the block.
struct BlockSlack {
  /// Least margin of a link below its limit, negative if snow can never be sure to rest; the same
  /// for links over open edges.
  float inside = -1.0f;
  float at_edges = -1.0f;
  /// Maximum shared::column_height, and its maximum difference across a link.
  float column = 0.0f;
  float turn = 0.0f;
  /// The side of the surface on which snow can rest: see shared::snow_side.
  float side = 1.0f;

  /// Whether no link exceeds its limit under snow that is up to `high` thick and differs by at most
  /// `step` across a link: two columns, each up to `column` times as high as thick, with factors
  /// that differ by `turn`, differ in height by at most step * column + high * turn.
  bool is_level(float high, float step) const {
    return step * column + high * turn <= inside && high * column <= at_edges;
  }
};

/// Evaluates a block's texels and those to which they are linked. Stops at the first that is too
/// steep for snow to rest. `places`: TexelTable::texel.
BlockSlack find_slack(const ReposeSurface& surface, const ReposeLinks& links,
                      const std::vector<int32_t>& places, int32_t block,
                      const ReposeLimits& limits);

}  // namespace snowbough::snow
