#pragma once

#include <cstdint>
#include <limits>

#include "snow/movement/repose/window.h"

namespace snowbough::snow {

/// The limit of a link that does not exist.
inline constexpr float kNoLink = std::numeric_limits<float>::infinity();

/// Steepest slope of snow: tangent of the angle of repose; and the cohesion in metres, see
/// shared::held_slope.
struct ReposeLimits {
  float slope = 0.0f;
  float cohesion = 0.0f;
  /// Whether heaps are round: see granular.h.
  bool is_granular = false;
  bool operator==(const ReposeLimits&) const = default;
};

/// The bare surface of the cells in a block's window, from which the limits of its links follow.
struct alignas(64) BareWindow {
  /// Points in metres, covered areas in m2 (0: no texel), and sums of the principal curvatures in
  /// 1/m.
  TileWindow::Plane x, y, z, area, curvature;
  /// Tangents of the slopes: shared::bare_slope.
  TileWindow::Plane steep;
  /// 1 on walls, else 0.
  TileWindow::Plane wall;
};

/// The limits of the links from a row of a block to the forward neighbours: shared::link_limit, in
/// metres; kNoLink where there is none. Nothing moves on walls, onto which OutletLinks lead; snow
/// at the foot of a wall leans against it. `forward`: ReposeLinks::forward of the row; `limit`: the
/// row's first in each of kForwardLinks arrays.
void find_link_limits(const BareWindow& bare, int32_t row, const uint8_t* forward,
                      const ReposeLimits& limits, float* const* limit);

}  // namespace snowbough::snow
