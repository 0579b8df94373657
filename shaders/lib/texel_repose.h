#pragma once

// Repose: snow whose own surface is steeper than the angle of repose moves to what lies lower. For C++ and GLSL.
//
// Between two neighbouring texels a link carries snow from the higher surface point to the lower one. What flows in
// a round is a part of what the height difference is over its limit, and it keeps its momentum from round to
// round: heavy-ball relaxation (B. T. Polyak, Some methods of speeding up the convergence of iteration methods,
// 1964, with the growing momentum k / (k + a) of Y. Nesterov, 1983, and a over 3 as A. Chambolle and C. Dossal, On the
// convergence of the iterates of FISTA, 2015, have it, so that it does not swing), which comes to rest on a bank of L
// texels in a few L rounds where plain relaxation takes L^2. Snow starts to flow over the limit and comes to rest a little
// under it, so that a round without flow is rest. Flows are whole units of volume, so that what leaves one texel
// arrives at the other to the last bit; where more is wanted of a texel than it holds, all get their part of it.
#include "shared_functions.h"

#ifndef SNOWBOUGH_GLSL
namespace snowbough::shared {
#endif

/// What faces less upwards than this holds no snow: what moves there falls.
KERNEL_CONSTANT float kWallUp = 0.1f;
/// Seconds in which what sticks on a wall halves: after a frame, a twentieth is left. With more, the walls of round
/// things show a stripe while it snows, above which they are bare: what is steep but no wall sheds its snow at once.
KERNEL_CONSTANT float kWallHalfLife = 0.01f;
/// Metres below which it is gone.
KERNEL_CONSTANT float kWallLeast = 1e-5f;
/// Parts of a link's limit at which snow that flows would rest, and below which it stops at once.
KERNEL_CONSTANT float kRests = 0.96f;
KERNEL_CONSTANT float kStops = 0.92f;
/// Part of a link's limit that snow over an outlet (a rim or a wall) is cut to; and by which part of its thickness snow
/// may be thinner than that and still count as cut.
KERNEL_CONSTANT float kCuts = 0.98f;
KERNEL_CONSTANT float kNearlyCut = 0.2f;
/// Metres that no surface reaches.
KERNEL_CONSTANT float kUnbounded = 3e38f;
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
/// See link_limit, of links on the map, several of which lead down; and of others.
KERNEL_CONSTANT float kLeadsDown = 0.5f;
KERNEL_CONSTANT float kAllLeadDown = 0.0f;
/// Tangent of the steepest slope that holds together on what is curved, 82 degrees.
KERNEL_CONSTANT float kSteepestHeld = 7.1f;
/// On which side of a surface snow lies: 1 along the normal, -1 against it. `height`: signed; `up`: upward part of
/// the normal. A bare surface that takes snow on both sides shows the one that faces up.
SNOWBOUGH_SHARED_FUNCTION float snow_side(float height, float up, bool both_sides) {
  return height < 0.0f || (height == 0.0f && both_sides && up < 0.0f) ? -1.0f : 1.0f;
}

/// `up`: upward part of the normal on the side of the snow, as a TexelSurface has it.
SNOWBOUGH_SHARED_FUNCTION bool is_wall(float up) { return up < kWallUp; }

/// Metres of snow's surface, straight up, for a metre of thickness along the normal: a column over the same part of the
/// ground holds as much. `up`: upward part of the normal on the side of the snow.
SNOWBOUGH_SHARED_FUNCTION float column_height(float up) { return 1.0f / max(up, kWallUp); }

/// Metres by which the surface of the snow may fall between two neighbours. `way`: from one bare point to the other,
/// level; `slope`: tangent of the angle; `fall`: of the bare surface on that way; `steep`: tangent of its own slope.
/// Where that is too steep for snow, a link that leads down at an angle allows its part of a slope at rest straight
/// down, or snow would stay where the layout has no link straight down. `leads_down`: cosine of the angle between the
/// two up to which it does.
SNOWBOUGH_SHARED_FUNCTION float link_limit(float way, float slope, float fall, float steep, float leads_down) {
  float part = min(abs(fall) / max(way * steep, 1e-12f), 1.0f);
  float even = kEven * slope;
  float led = part >= leads_down ? part : 1.0f;
  return even * way * (steep > even ? led : 1.0f);
}
/// Tangent of a surface's slope. `up`: upward part of its normal.
SNOWBOUGH_SHARED_FUNCTION float bare_slope(float up) {
  float part = clamp(abs(up), kWallUp, 1.0f);
  return sqrt(1.0f - part * part) / part;
}

/// Tangent of the angle up to which snow rests on a surface. A front of snow that holds together stands upright up to a
/// height that belongs to the snow, `cohesion` metres (for soils 4 c / gamma tan(45 + phi / 2): K. Terzaghi, Theoretical
/// Soil Mechanics, 1943), so the smaller the steeper: on a limb of that radius slopes are twice as steep as at rest on
/// level ground, on thick ones hardly steeper; nor on what is much thinner, as needles, from which such a front falls
/// off. `slope`: of the angle of repose; `curvature`: sum of the principal
/// curvatures in 1/m, positive where the surface is convex.
SNOWBOUGH_SHARED_FUNCTION float held_slope(float slope, float cohesion, float curvature) {
  const float thin = cohesion * max(curvature, 0.0f);
  return max(slope, min(slope * (1.0f + 2.0f * thin / (1.0f + thin * thin)), kSteepestHeld));
}

/// The height that the snow's surface may have on a texel over an outlet, as far as it bounds its neighbours too: it
/// does where it cuts the snow, or nearly. `top`: height of the snow's surface, `bare`: of the surface below.
SNOWBOUGH_SHARED_FUNCTION float passed_bound(float bound, float top, float bare) {
  const float least = max(bound, bare);
  return bound - kNearlyCut * (least - bare) <= top ? least : kUnbounded;
}

/// Units of volume that flow for a metre of excess. `stiffness` of an end: metres by which a unit lifts its
/// surface, times its links and at least kLinks.
SNOWBOUGH_SHARED_FUNCTION float link_rate(float stiffness_a, float stiffness_b) {
  return kRate * kLinks / max(stiffness_a, stiffness_b);
}

/// What part of its last flow a link keeps in round `round` (0, 1, ...).
SNOWBOUGH_SHARED_FUNCTION float flow_momentum(int round) { return float(round) / float(round + 8); }

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
