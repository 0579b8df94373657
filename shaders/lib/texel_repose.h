#pragma once

// Repose: snow whose own surface is steeper than the angle of repose moves to what lies lower. For C++ and GLSL.
//
// Between two neighbouring texels a link carries snow from the higher surface point to the lower one. What flows in
// a round is a part of what the height difference is over its limit, and it keeps its momentum from round to
// round: heavy-ball relaxation (B. T. Polyak, Some methods of speeding up the convergence of iteration methods,
// 1964, with the growing momentum k / (k + 3) of Y. Nesterov, 1983), which comes to rest on a bank of L texels in
// about 3 L rounds where plain relaxation takes L^2. Snow starts to flow over the limit and comes to rest a little
// under it, so that a round without flow is rest. Flows are whole units of volume, so that what leaves one texel
// arrives at the other to the last bit; where more is wanted of a texel than it holds, all get their part of it.
#include "shared_functions.h"

#ifndef SNOWBOUGH_GLSL
namespace snowbough::shared {
#endif

/// What faces less upwards than this holds no snow: what moves there falls.
KERNEL_CONSTANT float kWallUp = 0.1f;
/// Seconds in which what sticks on a wall halves: after a second less than a hundred-thousandth is left.
KERNEL_CONSTANT float kWallHalfLife = 0.0595f;
/// Metres below which it is gone.
KERNEL_CONSTANT float kWallLeast = 1e-5f;
/// Parts of a link's limit at which snow that flows would rest, and below which it stops at once.
KERNEL_CONSTANT float kRests = 0.94f;
KERNEL_CONSTANT float kStops = 0.86f;
/// Units in which volumes flow: parts of a metre on a texel of the object's mean area; and the most that a link
/// carries in a round, so that sums over a texel's links are whole in a float.
KERNEL_CONSTANT float kUnitsAMetre = 16777216.0f;
KERNEL_CONSTANT float kMostFlow = 524288.0f;
/// Links that a texel in the middle of a chart has.
KERNEL_CONSTANT float kLinks = 8.0f;
/// Which part of the excess flows in a round where two texels alike have eight links each.
KERNEL_CONSTANT float kRate = 0.2f;
/// Links in eight directions let a slope between two of them be up to 1 / cos(22.5 degrees) = 1.08 times as steep: by
/// this much each allows less, so that all directions have the angle of repose in the mean.
KERNEL_CONSTANT float kEven = 0.95f;
/// Part of the way between two bare points that snow on them is reckoned to be apart at least, in hollows and where
/// it hangs over; and at most: on a ridge, where snow's surface fans out along the normals, it reaches out a little
/// beyond what carries it, but does not hold itself up by its own thickness.
KERNEL_CONSTANT float kLeastWay = 0.25f;
KERNEL_CONSTANT float kMostWay = 1.3f;

/// On which side of a surface snow lies: 1 along the normal, -1 against it. `height`: signed; `up`: upward part of
/// the normal. A bare surface that takes snow on both sides shows the one that faces up.
SNOWBOUGH_SHARED_FUNCTION float snow_side(float height, float up, bool both_sides) {
  return height < 0.0f || (height == 0.0f && both_sides && up < 0.0f) ? -1.0f : 1.0f;
}

/// `up`: upward part of the normal on the side of the snow, as a TexelSurface has it.
SNOWBOUGH_SHARED_FUNCTION bool is_wall(float up) { return up < kWallUp; }

/// Metres by which the surface of the snow may fall between two neighbours. `way_x`, `way_y`: from one bare point
/// to the other, level; `snow_x`, `snow_y`: from one snow's surface to the other's; `slope`: tangent of the angle.
SNOWBOUGH_SHARED_FUNCTION float link_limit(float way_x, float way_y, float snow_x, float snow_y, float slope) {
  const float way = sqrt(way_x * way_x + way_y * way_y);
  const float along = way > 0.0f ? (snow_x * way_x + snow_y * way_y) / way : 0.0f;
  return kEven * slope * clamp(along, kLeastWay * way, kMostWay * way);
}

/// Units of volume that flow for a metre of excess. `stiffness` of an end: metres by which a unit lifts its
/// surface, times its links and at least kLinks.
SNOWBOUGH_SHARED_FUNCTION float link_rate(float stiffness_a, float stiffness_b) {
  return kRate * kLinks / max(stiffness_a, stiffness_b);
}

/// What part of its last flow a link keeps in round `round` (0, 1, ...).
SNOWBOUGH_SHARED_FUNCTION float flow_momentum(int round) { return float(round) / float(round + 3); }

/// Units that would flow from a to b in a round (negative: from b to a). `before`: what did in the round before;
/// `fall`: height of a's surface over b's; `limit` and `fall` in metres.
SNOWBOUGH_SHARED_FUNCTION float wanted_flow(float before, float fall, float limit, float rate, float momentum) {
  const float steep = abs(fall);
  const float onwards = fall < 0.0f ? -before : before;
  const float wanted = max(min(momentum * onwards + rate * (steep - kRests * limit), kMostFlow), 0.0f);
  const float least = onwards > 0.0f ? kStops * limit : limit;
  const float flow = steep > least ? wanted : 0.0f;
  return fall < 0.0f ? -flow : flow;
}

/// Which part of what is wanted of a texel it can give: `held` and `wanted` in units.
SNOWBOUGH_SHARED_FUNCTION float given_part(float held, float wanted) { return wanted > held ? held / wanted : 1.0f; }

/// What does flow, in whole units: `part` is the giver's.
SNOWBOUGH_SHARED_FUNCTION float given_flow(float wanted, float a_part, float b_part) {
  return wanted < 0.0f ? -floor(-wanted * b_part) : floor(wanted * a_part);
}

#ifndef SNOWBOUGH_GLSL
}  // namespace snowbough::shared
#endif
