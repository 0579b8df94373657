#pragma once

// Repose: snow whose own surface is steeper than the angle of repose moves to lower neighbours. For C++ and GLSL.
//
// A link between two neighbouring texels carries snow from the higher surface point to the lower one. The flow of a
// round is a fraction of the height difference beyond the limit, plus momentum from the previous round: heavy-ball
// relaxation (B. T. Polyak, Some methods of speeding up the convergence of iteration methods, 1964, with the growing
// momentum k / (k + a) of Y. Nesterov, 1983, and a over 3 as in A. Chambolle and C. Dossal, On the convergence of the
// iterates of FISTA, 2015, so that it does not oscillate). A slope of L texels converges in a few L rounds, where plain
// relaxation takes L^2. Snow starts to flow above the limit and stops slightly below it, so that a round without flow
// is final. Flows are whole units of volume, so that exactly what leaves one texel arrives at the other; if more is
// requested of a texel than it holds, all links get the same fraction.
#include "shared_functions.h"

#ifndef SNOWBOUGH_GLSL
namespace snowbough::shared {
#endif

/// Surfaces with a smaller upward part hold no snow: snow that moves there falls.
KERNEL_CONSTANT float kWallUp = 0.1f;
/// Half-life in seconds of snow that sticks to a wall: a twentieth is left after a frame. With a longer one, the walls
/// of round objects would show a stripe during snowfall, with bare surface above it, since slopes that are steep but no
/// walls shed their snow at once.
KERNEL_CONSTANT float kWallHalfLife = 0.01f;
/// Thickness in metres below which it is removed.
KERNEL_CONSTANT float kWallLeast = 1e-5f;
/// Fractions of a link's limit at which flowing snow would rest, and below which it stops at once.
KERNEL_CONSTANT float kRests = 0.96f;
KERNEL_CONSTANT float kStops = 0.92f;
/// Fraction of a link's limit to which snow above an outlet (a rim or a wall) is cut; and the fraction of its thickness
/// by which snow may be thinner than that and still count as cut.
KERNEL_CONSTANT float kCuts = 0.98f;
KERNEL_CONSTANT float kNearlyCut = 0.2f;
/// A height in metres that no surface reaches.
KERNEL_CONSTANT float kUnbounded = 3e38f;
/// Units of volume per metre on a texel of the object's mean area; and the maximum flow of a link per round, so that
/// sums over a texel's links are exact in a float.
KERNEL_CONSTANT float kUnitsAMetre = 16777216.0f;
KERNEL_CONSTANT float kMaxFlow = 524288.0f;
/// Number of links of a texel in the middle of a chart.
KERNEL_CONSTANT float kLinks = 8.0f;
/// Fraction of the excess that flows per round between two equal texels with eight links each.
KERNEL_CONSTANT float kRate = 0.2f;
/// With links in eight directions a slope between two of them could be up to 1 / cos(22.5 degrees) = 1.08 times as
/// steep: this factor makes the mean over all directions equal the angle of repose.
KERNEL_CONSTANT float kEven = 0.95f;
/// See link_limit: for links on the map, several of which lead down; and for others.
KERNEL_CONSTANT float kLeadsDown = 0.5f;
KERNEL_CONSTANT float kAllLeadDown = 0.0f;
/// Tangent of the steepest slope that cohesion holds on curved surfaces, 82 degrees.
KERNEL_CONSTANT float kSteepestHeld = 7.1f;
/// Side of the surface on which snow lies: 1 along the normal, -1 against it. `height`: signed; `up`: upward part of
/// the normal. A bare surface that takes snow on both sides uses the one that faces up.
SNOWBOUGH_SHARED_FUNCTION float snow_side(float height, float up, bool both_sides) {
  return height < 0.0f || (height == 0.0f && both_sides && up < 0.0f) ? -1.0f : 1.0f;
}

/// `up`: upward part of the normal on the snow's side, as in TexelSurface.
SNOWBOUGH_SHARED_FUNCTION bool is_wall(float up) { return up < kWallUp; }

/// Vertical height of the snow's surface per metre of thickness along the normal: a column over the same ground area
/// holds the same volume. `up`: upward part of the normal on the snow's side.
SNOWBOUGH_SHARED_FUNCTION float column_height(float up) { return 1.0f / max(up, kWallUp); }

/// Maximum height difference, in metres, of the snow's surface between two neighbours. `distance`: horizontal distance
/// between the bare points; `slope`: tangent of the angle; `fall`: height difference of the bare points; `steep`:
/// tangent of the bare surface's slope. If the bare surface is steeper than snow can be, a link that leads down
/// obliquely is limited to its share of the slope straight down; otherwise snow would stay where the layout has no link
/// straight down. `leads_down`: minimum cosine between the link and straight down for this.
SNOWBOUGH_SHARED_FUNCTION float link_limit(float distance, float slope, float fall, float steep, float leads_down) {
  float part = min(abs(fall) / max(distance * steep, 1e-12f), 1.0f);
  float even = kEven * slope;
  float allowed_part = part >= leads_down ? part : 1.0f;
  return even * distance * (steep > even ? allowed_part : 1.0f);
}
/// Tangent of a surface's slope. `up`: upward part of its normal.
SNOWBOUGH_SHARED_FUNCTION float bare_slope(float up) {
  float part = clamp(abs(up), kWallUp, 1.0f);
  return sqrt(1.0f - part * part) / part;
}

/// Tangent of the steepest slope at which snow rests on a surface. A vertical face of cohesive snow stays up to a
/// height that is a property of the snow, `cohesion` metres (for soils 4 c / gamma tan(45 + phi / 2): K. Terzaghi,
/// Theoretical Soil Mechanics, 1943), so smaller bodies hold steeper snow: on a limb of that radius slopes are twice as
/// steep as on level ground, on thick limbs hardly steeper; nor on much thinner ones such as needles, from which such a
/// face falls off. `slope`: tangent of the angle of repose; `curvature`: sum of the principal curvatures in 1/m,
/// positive if the surface is convex.
SNOWBOUGH_SHARED_FUNCTION float held_slope(float slope, float cohesion, float curvature) {
  const float thin = cohesion * max(curvature, 0.0f);
  return max(slope, min(slope * (1.0f + 2.0f * thin / (1.0f + thin * thin)), kSteepestHeld));
}

/// The bound on the snow's surface at a texel above an outlet, as far as it also bounds its neighbours: if it cuts the
/// snow, or nearly. `top`: height of the snow's surface, `bare`: of the surface below.
SNOWBOUGH_SHARED_FUNCTION float passed_bound(float bound, float top, float bare) {
  const float least = max(bound, bare);
  return bound - kNearlyCut * (least - bare) <= top ? least : kUnbounded;
}

/// Flow in units of volume per metre of excess. `stiffness` of an end: rise in metres of its surface per unit, times
/// its links, at least kLinks.
SNOWBOUGH_SHARED_FUNCTION float link_rate(float stiffness_a, float stiffness_b) {
  return kRate * kLinks / max(stiffness_a, stiffness_b);
}

/// The fraction of its last flow that a link keeps in round `round` (0, 1, ...).
SNOWBOUGH_SHARED_FUNCTION float flow_momentum(int round) { return float(round) / float(round + 8); }

/// Units that would flow from a to b in a round (negative: from b to a). `before`: flow of the previous round; `fall`:
/// height of a's surface above b's; `limit` and `fall` in metres.
SNOWBOUGH_SHARED_FUNCTION float wanted_flow(float before, float fall, float limit, float rate, float momentum) {
  const float steep = abs(fall);
  const float onwards = fall < 0.0f ? -before : before;
  const float wanted = max(min(momentum * onwards + rate * (steep - kRests * limit), kMaxFlow), 0.0f);
  const float least = onwards > 0.0f ? kStops * limit : limit;
  const float flow = steep > least ? wanted : 0.0f;
  return fall < 0.0f ? -flow : flow;
}

/// The fraction of the requested units that a texel can give: `held` and `wanted` in units.
SNOWBOUGH_SHARED_FUNCTION float given_part(float held, float wanted) { return wanted > held ? held / wanted : 1.0f; }

/// The actual flow, in whole units, from the giver's fraction.
SNOWBOUGH_SHARED_FUNCTION float given_flow(float wanted, float a_part, float b_part) {
  return wanted < 0.0f ? -floor(-wanted * b_part) : floor(wanted * a_part);
}

#ifndef SNOWBOUGH_GLSL
}  // namespace snowbough::shared
#endif
