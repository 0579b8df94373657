#include "snow/movement/repose/link_limits.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/simd.h"
#include "shaders/lib/texel_repose.h"

namespace snowbough::snow {
namespace {

using Numbers = std::array<float, kReposeBlock>;

/// Converts bytes to 1 if they have the bit, else 0.
inline void spread_bit(const uint8_t* __restrict bytes, uint8_t bit, float* __restrict to) {
  for (int32_t i = 0; i < kReposeBlock; ++i) to[i] = (bytes[i] & bit) != 0 ? 1.0f : 0.0f;
}

/// Positive for links that are open, if `linked` is 1, else 0: a minimum of numbers, since mixing
/// booleans would prevent vectorisation. Neither cell may be a wall.
inline void find_open(const BareWindow& bare, size_t at, int32_t step,
                      const float* __restrict linked, float* __restrict open) {
  const float* const area = bare.area.data() + at;
  const float* const wall = bare.wall.data() + at;
  for (int32_t i = 0; i < kReposeBlock; ++i) {
    const int32_t j = i + step;
    const float there = std::min(std::min(area[i], area[j]), linked[i]);
    open[i] = std::min(there, 0.5f - (wall[i] + wall[j]));
  }
}

/// Limits without cohesion where no link is limited to its share of the slope straight down, which
/// divides nothing. Returns whether that is so everywhere.
inline bool limit_gentle_row(const BareWindow& bare, size_t at, int32_t step,
                             const float* __restrict open, const ReposeLimits& limits,
                             float* __restrict limit) {
  const float* const x = bare.x.data() + at;
  const float* const y = bare.y.data() + at;
  const float* const steep = bare.steep.data() + at;
  const float even = shared::kEven * limits.slope;
  int32_t any_steep = 0;
  for (int32_t i = 0; i < kReposeBlock; ++i) {
    const int32_t j = i + step;
    const float way_x = x[j] - x[i];
    const float way_y = y[j] - y[i];
    const float way = std::sqrt(way_x * way_x + way_y * way_y);
    any_steep |= ((open[i] > 0.0f) & (0.5f * (steep[i] + steep[j]) > even)) ? 1 : 0;
    limit[i] = open[i] > 0.0f ? even * way : kNoLink;
  }
  return any_steep == 0;
}

inline void limit_row(const BareWindow& bare, size_t at, int32_t step, const float* __restrict open,
                      const ReposeLimits& limits, float* __restrict limit) {
  const float* const x = bare.x.data() + at;
  const float* const y = bare.y.data() + at;
  const float* const z = bare.z.data() + at;
  const float* const steep = bare.steep.data() + at;
  const float* const curvature = bare.curvature.data() + at;
  const float slope_at_rest = limits.slope;
  const float cohesion = limits.cohesion;
  for (int32_t i = 0; i < kReposeBlock; ++i) {
    const int32_t j = i + step;
    const float way_x = x[j] - x[i];
    const float way_y = y[j] - y[i];
    const float slope =
        shared::held_slope(slope_at_rest, cohesion, 0.5f * (curvature[i] + curvature[j]));
    const float allowed =
        shared::link_limit(std::sqrt(way_x * way_x + way_y * way_y), slope, z[i] - z[j],
                           0.5f * (steep[i] + steep[j]), shared::kLeadsDown);
    limit[i] = open[i] > 0.0f ? allowed : kNoLink;
  }
}

SNOWBOUGH_WIDE_FLAT void limit_links(const BareWindow& bare, size_t at, const uint8_t* forward,
                                     const ReposeLimits& limits, float* const* limit) {
  for (int32_t k = 0; k < kForwardLinks; ++k) {
    const int32_t step = TileWindow::step(k);
    Numbers linked;
    Numbers open;
    spread_bit(forward, static_cast<uint8_t>(1 << k), linked.data());
    find_open(bare, at, step, linked.data(), open.data());
    if (limits.cohesion != 0.0f ||
        !limit_gentle_row(bare, at, step, open.data(), limits, limit[k])) {
      limit_row(bare, at, step, open.data(), limits, limit[k]);
    }
  }
}

}  // namespace

void find_link_limits(const BareWindow& bare, int32_t row, const uint8_t* forward,
                      const ReposeLimits& limits, float* const* limit) {
  limit_links(bare, TileWindow::at(0, row), forward, limits, limit);
}

}  // namespace snowbough::snow
