#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "snow/seams/seam_table.h"
#include "snow/texels/texel_table.h"

namespace snowbough::snow {

/// The thesis's taps, on one side: offsets in texels and weights, whose sum over both sides is
/// divided out.
inline constexpr std::array<double, 3> kTapOffset{0.0, 1.3846, 3.2307};
inline constexpr std::array<double, 3> kTapWeight{0.2270, 0.3162, 0.0702};
inline constexpr double kTapSum = kTapWeight[0] + 2.0 * (kTapWeight[1] + kTapWeight[2]);

/// The separable 5-tap Gaussian of D. T. Reynolds, Real-Time Rendering and Simulation of Trees and
/// Snow, 2014, section 4.2: taps at 0, +-1.3846 and +-3.2307 texels, each between two texels and
/// interpolated, with the weights 0.2270, 0.3162 and 0.0702. One pass at full scale has a standard
/// deviation of 1.69 texels. A scaled pass moves the taps inwards.

/// Weights of a texel and of its first to fourth neighbours on either side:
/// w[0] + 2 (w[1] + .. + w[4]) = 1.
using FilterWeights = std::array<float, kFilterReach + 1>;

/// Scales of the filter that texels choose from: 0 (nothing) to 255 (standard deviation 1.69).
inline constexpr int32_t kFilterLevels = 256;

/// The weights of each level; the standard deviation grows evenly from level to level.
const std::array<FilterWeights, kFilterLevels>& filter_levels();

/// By what a level scales the taps' offsets, 0 to 1, in steps of this.
uint16_t filter_scale(int32_t level);
inline constexpr float kFilterScaleStep = 1.0f / 32768.0f;

/// Standard deviation of level 255 in texels.
double full_filter_sigma();

/// How a map is to be smoothed: `passes` times along u, then along v; then `closing_passes` times
/// by the mean of both. Where a seam turns the layout, one side's u is the other's v, so that the
/// sides filter in different order and end a little apart. A closing pass filters both ways at once
/// from one input, which is the same seen from either side, and closes the gap.
struct SmoothingPlan {
  /// Both 0 where nothing is smoothed: the map is passed on as it is.
  int32_t passes = 0;
  int32_t closing_passes = 0;
  /// Per owned texel: level of the filter along u and along v. A texel that is longer than others
  /// takes a smaller level, so that the radius is the same in metres everywhere.
  std::vector<uint8_t> level_u;
  std::vector<uint8_t> level_v;
};

/// Plans a Gaussian of the standard deviation `blur_radius` (metres, on the surface; 0 = none).
/// There are as many passes as the map's fine texels need (the finest tenth of its surface
/// excepted), 64 at most: a radius over 13.5 of those texels comes out smaller. Texels far longer
/// than the radius are hardly smoothed at all, as it should be.
/// @throws std::invalid_argument for a negative or not finite radius.
SmoothingPlan plan_smoothing(const TexelTable& table, const SeamTable& seams, float blur_radius);

}  // namespace snowbough::snow
