#pragma once

// The look of snow of a known thickness: the one formula for Blender's mesh, the live preview, Snowbough Realtime and
// the exporters. A point of the surface is its carrier on the receiver plus an offset. Away from rims the offset
// follows the normal (thin_snow, sagging). Near a rim it follows a profile of an upright face, a round shoulder, an
// overhang and a drop (front_offset). All lengths are in metres. All vectors are in the pose for which the surface was
// planned.
//
// Sources: superellipses, A. H. Barr, Superquadrics and Angle-Preserving Transformations, IEEE CG&A 1 (1), 1981; round
// lips and cornices at the edges of snow, P. Fearing, Computer Modelling of Fallen Snow, SIGGRAPH 2000, section 3.
#include "shared_functions.h"
#include "snow_style.h"

#ifndef SNOWBOUGH_GLSL
#include <glm/gtc/constants.hpp>
namespace snowbough::shared {
using glm::cos;
using glm::exp;
using glm::mix;
using glm::normalize;
using glm::sin;
using glm::smoothstep;
#endif

/// Constants of a point away from rims.
struct SnowPoint {
  /// Noise, from about -1 to 1: of the thickness below which no snow shows, of lips and sagging, of the surface noise,
  /// and of bumps.
  float patches;
  float hem;
  float relief;
  float bumps;
  /// Greatest depth of bare parts below the receiver's surface.
  float deepest;
  /// Relative growth of the surface's area per metre along its normals, in 1/m; 0 on flat or concave places.
  float convexity;
  /// 0 on wide ground, 1 on tops and twigs so narrow that the snow is thin for lack of room, not because of shelter.
  float narrow;
};

/// Constants of a point near a rim.
struct SnowFront {
  /// Distance to the rim; negative beyond it, on the far face. On a bevel: distance inwards from the line at which the
  /// faces meet, less `below`, the distance below that line. `bevel`: width of the bevel.
  float distance;
  float below;
  float bevel;
  /// Width of the zone in which snow is drawn to the rim; greatest distance of the snow down the far face.
  float zone;
  float far_zone;
  /// 0 without snow behind the rim in the last frame, 1 with snow.
  float presence;
  /// Outward slope of the rim, 0 to 1, as at eaves.
  float eave;
  /// 1 if a face goes down from the rim, 0 if the surface ends there.
  float has_far;
  /// Mean thickness of the map in the zone, as a fraction of that behind the rim.
  float full;
  /// 0 without an opposite rim, 1 if a rim lies opposite across a gap; half the gap's width; half the height of the
  /// other rim above this one.
  float bridged;
  float half_gap;
  float half_step;
  /// Additional overhang on the lee side due to wind, as a fraction of the height.
  float lee;
  /// Noise at the rim, from about -1 to 1.
  float noise_slow;
  float noise_fast;
  float noise_shoulder;
  /// Unit vectors: outwards in the plane of the supporting face; the same direction made level; down the far face.
  /// `lift` points between the support's normal and the vertical. It is scaled so that `lift` times a height reaches
  /// that height above the support.
  vec3 outward;
  vec3 level_out;
  vec3 down;
  vec3 lift;
  /// Unit normal of the supporting face.
  vec3 support;
};

// Away from rims.
/// Upward components of the normal: a surface is level above the first and steep below the second.
KERNEL_CONSTANT float kLevel = 0.93f;
KERNEL_CONSTANT float kSteep = 0.45f;
/// Thickness that does not show, as a fraction of the open depth, on steep places and where shelter thins the snow;
/// multiplied by 0.22 + 0.85 noise.
KERNEL_CONSTANT float kSteepShare = 0.65f;
KERNEL_CONSTANT float kShelterShare = 0.10f;
/// Reduction of these fractions on narrow places.
KERNEL_CONSTANT float kNarrowKeeps = 0.85f;
/// Walls are surfaces with a smaller upward component of the normal. They show no snow thinner than this fraction of
/// the open depth: such snow has just slid over a rim, or comes from the neighbouring chart through the map's gutter.
KERNEL_CONSTANT float kWall = 0.15f;
KERNEL_CONSTANT float kWallShare = 0.1f;
/// Snow thinner than this, in metres and as a fraction of the open depth, is frost and does not show.
KERNEL_CONSTANT float kFrost = 0.0025f;
KERNEL_CONSTANT float kFrostShare = 0.05f;
/// Until open ground has the first depth, in metres, the threshold is raised by up to the second: without snow, the whole
/// surface must lie clearly below the receiver.
KERNEL_CONSTANT float kFirstDepth = 0.001f;
KERNEL_CONSTANT float kFirstFrost = 0.0003f;
/// Height of the lip at the edge of the snow, as a fraction of the open depth.
KERNEL_CONSTANT float kLip = 0.22f;
KERNEL_CONSTANT float kSink = 0.004f;
/// Fractions of the thickness.
KERNEL_CONSTANT float kSag = 0.6f;
KERNEL_CONSTANT float kSagVariation = 0.5f;
KERNEL_CONSTANT float kMaxSag = 1.4f;
KERNEL_CONSTANT float kRelief = 0.13f;
KERNEL_CONSTANT float kBumps = 0.08f;
KERNEL_CONSTANT float kMaxRelief = 0.11f;

// At rims. Lengths are fractions of the height behind the rim.
/// Position in the zone, from 0 at the rim to 1, where the front ends and the top begins.
KERNEL_CONSTANT float kFrontPart = 0.5f;
/// Fraction of the far zone at which the hem closes; points beyond it lie inside the receiver.
KERNEL_CONSTANT float kTucked = 0.68f;
KERNEL_CONSTANT float kTuck = 0.002f;
/// The lower part of a front that stands in snow: how far it leans into that snow, and how far down it reaches.
KERNEL_CONSTANT float kOverlap = 0.06f;
/// Snow beyond the rim that reaches this fraction of the height of the snow on this side covers the rim.
KERNEL_CONSTANT float kCoversRim = 0.4f;
/// Sinking of a front that snow beyond covers, as a fraction of its open height.
KERNEL_CONSTANT float kSettles = 0.35f;
KERNEL_CONSTANT float kBuried = 0.25f;
/// Height of the outermost point of the front.
KERNEL_CONSTANT float kBelly = 0.38f;
KERNEL_CONSTANT float kShoulder = 0.8f;
/// Gaps wider than this fraction of the snow's height stay open; gaps narrower than the second fraction are bridged.
KERNEL_CONSTANT float kBridgedGap = 0.7f;
KERNEL_CONSTANT float kSurelyBridged = 0.55f;
/// A bridge lies lower than the snow by the first fraction, and lower by the second in its middle. Each side reaches
/// beyond the middle by the third.
KERNEL_CONSTANT float kBridgeSag = 0.01f;
KERNEL_CONSTANT float kBridgeDip = 0.06f;
KERNEL_CONSTANT float kBridgeOverlap = 0.15f;
/// Snow across the gap that is lower than the first fraction of the snow on this side carries no bridge; snow higher
/// than the second does.
KERNEL_CONSTANT float kBareAcross = 0.15f;
KERNEL_CONSTANT float kSnowAcross = 0.3f;
KERNEL_CONSTANT float kUpperExponent = 2.3f;
KERNEL_CONSTANT float kLowerExponent = 2.1f;
KERNEL_CONSTANT float kEaveExponent = 3.0f;

/// Smooth step from 0 at `from` to 1 at `to`. `to` may be less than `from`.
SNOWBOUGH_SHARED_FUNCTION float eased(float x, float from, float to) {
  const float t = clamp((x - from) / (to - from), 0.0f, 1.0f);
  return t * t * (3.0f - 2.0f * t);
}

SNOWBOUGH_SHARED_FUNCTION float steepness(float up) { return eased(up, kLevel, kSteep); }

/// Shape of the snow's border.
struct SnowEdge {
  /// Thickness below which no snow shows.
  float threshold;
  float lip;
  /// Depth of bare parts below the receiver's surface.
  float sink;
};

/// `thickness`: thickness from the map at this point; `open_depth`: snow depth on open level ground in this frame;
/// `up`: upward component of the normal.
SNOWBOUGH_SHARED_FUNCTION SnowEdge snow_edge(KERNEL_CONST_REF(SnowPoint) point, float thickness, float open_depth,
                                             float up) {
  const float depth = max(open_depth, 1e-5f);
  const float steep = steepness(up);
  const float sheltered = eased(thickness / depth, 0.75f, 0.25f);
  const float share = max(kSteepShare * steep, kShelterShare * sheltered) * (1.0f - kNarrowKeeps * point.narrow);
  const float threshold = share * depth * clamp(0.22f + 0.85f * point.patches, 0.0f, 1.4f) +
                          kWallShare * depth * eased(up, kWall, 0.0f) +
                          min(kFrost, kFrostShare * depth) * (1.0f - kNarrowKeeps * point.narrow) +
                          kFirstFrost * max(1.0f - open_depth / kFirstDepth, 0.0f);
  const float lip = kLip * depth * (0.05f + 0.95f * steep) * clamp(0.8f + 0.5f * point.hem, 0.3f, 1.5f);
  const float sink = min(min(kSink, 0.3f * depth + 0.0008f), point.deepest);
  return KERNEL_MAKE3(SnowEdge, threshold, lip, sink);
}

/// Greatest shown height for a thickness, without the surface noise.
SNOWBOUGH_SHARED_FUNCTION float most_shown(float thickness) { return 1.5f * thickness + 0.004f; }

/// Height of the shown snow above the receiver's surface. It is negative where no snow shows, so that the snow ends
/// where two surfaces intersect. The caller smooths it over the surface to limit its slope.
SNOWBOUGH_SHARED_FUNCTION float thin_snow(KERNEL_CONST_REF(SnowEdge) edge, float thickness) {
  const float x = thickness - edge.threshold;
  if (x < 0.0f) return -edge.sink * (1.0f - exp(x / (0.25f * edge.sink + 0.1f * edge.lip + 1e-6f)));
  const float lip = sqrt(x * x + 2.0f * edge.lip * x * exp(-x / (2.5f * edge.lip)));
  const float kept = edge.threshold * (1.0f - exp(-x / edge.threshold));
  return min(lip + kept, most_shown(thickness));
}

/// Height of a layer on a convex surface with the same volume of snow as a layer of `height` on a flat surface. The
/// area of the layer grows with its height.
SNOWBOUGH_SHARED_FUNCTION float swept_height(KERNEL_CONST_REF(SnowPoint) point, float height) {
  if (height <= 0.0f || point.convexity * height < 1e-4f) return height;
  return (sqrt(1.0f + 2.0f * point.convexity * height) - 1.0f) / point.convexity;
}

/// Height of the surface noise.
SNOWBOUGH_SHARED_FUNCTION float surface_relief(KERNEL_CONST_REF(SnowPoint) point, KERNEL_CONST_REF(SnowStyle) style,
                                               float height, float open_depth) {
  const float wave = clamp(kRelief * point.relief + kBumps * point.bumps, -kMaxRelief, kMaxRelief);
  return style.relief * wave * min(max(height, 0.0f), open_depth);
}

/// Distance that snow hangs down the slope at its border on a steep place.
SNOWBOUGH_SHARED_FUNCTION float sagging(KERNEL_CONST_REF(SnowPoint) point, KERNEL_CONST_REF(SnowStyle) style,
                                        KERNEL_CONST_REF(SnowEdge) edge, float thickness, float height, float up) {
  const float x = max(thickness - edge.threshold, 0.0f);
  const float amount = clamp(kSag + style.hem_variation * kSagVariation * point.hem, 0.0f, kMaxSag);
  return style.overhang * max(height, 0.0f) * amount * exp(-x / (1.5f * edge.lip)) * steepness(up) *
         eased(up, -0.2f, 0.2f);
}

/// A quarter of a superellipse around `centre`: from `from` at turn 0 to `to` at turn 1.
SNOWBOUGH_SHARED_FUNCTION vec3 quarter(vec3 centre, vec3 from, vec3 to, float turn, float exponent) {
  const float angle = 1.5707963f * turn;
  const float power = 2.0f / exponent;
  return centre + (from - centre) * pow(max(cos(angle), 0.0f), power) +
         (to - centre) * pow(max(sin(angle), 0.0f), power);
}

/// Thickness of the snow behind a rim, and behind the rim across its gap. `beyond`: height of the snow below the rim, as
/// the thickness that snow on this side would need to be level with it; not over 0 where that snow is below the rim.
struct SnowBehind {
  float inland;
  float across;
  float beyond;
};

/// Fraction, 0 to 1, to which snow bridges the gap beyond a rim.
SNOWBOUGH_SHARED_FUNCTION float bridged_part(KERNEL_CONST_REF(SnowFront) front, KERNEL_CONST_REF(SnowStyle) style,
                                             KERNEL_CONST_REF(SnowBehind) behind) {
  const float height = max(behind.inland, 1e-5f);
  return clamp(front.bridged * style.bridging, 0.0f, 1.0f) *
         eased(2.0f * front.half_gap, kBridgedGap * height, kSurelyBridged * height) *
         eased(behind.across, kBareAcross * height, kSnowAcross * height);
}

/// Fractions, 0 to 1, to which the snow goes on beyond the rim: over a bridge; and over a bridge or over snow that
/// covers the rim.
struct SnowJoin {
  float bridged;
  float joined;
};

SNOWBOUGH_SHARED_FUNCTION SnowJoin snow_join(KERNEL_CONST_REF(SnowFront) front, KERNEL_CONST_REF(SnowStyle) style,
                                             KERNEL_CONST_REF(SnowBehind) behind) {
  const float bridged = front.bridged > 0.0f ? bridged_part(front, style, behind) : 0.0f;
  if (behind.beyond <= 0.0f) return KERNEL_MAKE2(SnowJoin, bridged, bridged);
  const float covered = eased(behind.beyond, 0.0f, kCoversRim * max(behind.inland, 1e-5f));
  return KERNEL_MAKE2(SnowJoin, bridged, max(bridged, covered));
}

/// Lengths of a front with snow of thickness `height`, which stands in snow of thickness `base`: the front is as high
/// as the difference.
struct SnowProfile {
  float height;
  float base;
  float overhang;
  float drop;
  float shoulder;
};

SNOWBOUGH_SHARED_FUNCTION SnowProfile front_profile(KERNEL_CONST_REF(SnowFront) front,
                                                    KERNEL_CONST_REF(SnowStyle) style,
                                                    KERNEL_CONST_REF(SnowBehind) behind,
                                                    KERNEL_CONST_REF(SnowJoin) join) {
  const float inland = behind.inland;
  const float slow = clamp(front.noise_slow * style.hem_variation, -1.3f, 1.3f);
  const float fast = clamp(front.noise_fast * style.hem_variation, -1.3f, 1.3f);
  const float shoulder_noise = clamp(front.noise_shoulder * style.hem_variation, -1.3f, 1.3f);
  const float bridged = join.bridged;
  const float joined = join.joined;
  const float full = inland * (1.0f - kBridgeSag * bridged);
  const float base = clamp(behind.beyond, 0.0f, full) * (1.0f - bridged);
  // Over a step that snow covers, the upper side is lower.
  const float height = full - kSettles * (full - base) * joined * (1.0f - bridged);
  const float open = height - base;
  // Each side is level up to the middle and dives below the other one beyond it, so that no edge shows between them.
  const float reach = front.half_gap + kBridgeOverlap * inland;
  const float eaves = 0.1f * max(slow, -0.5f) * front.eave;
  const float leaning = style.overhang * (max(0.10f + 0.14f * slow + 0.12f * fast, 0.02f) + eaves + front.lee);
  const float overhang = mix(open * min(leaning, 0.55f) + min(kOverlap * height, base), reach, bridged);
  const float hang = max(0.10f + 0.33f * fast * (1.0f + 0.8f * front.eave), 0.005f);
  const float drop = min(open * hang * (1.0f - 0.7f * bridged), 0.9f * front.far_zone);
  const float round = min(kShoulder * open * (1.0f + 0.25f * shoulder_noise), 0.62f * front.zone);
  return KERNEL_MAKE5(SnowProfile, height, base, overhang, drop, mix(round, -front.half_gap, bridged));
}

/// Offset from the carrier to a point of the front. `normal` and `height`: values of the point as if away from rims; `bumps`: noise; `sink`: depth of bare places.
SNOWBOUGH_SHARED_FUNCTION vec3 front_offset(KERNEL_CONST_REF(SnowFront) front, KERNEL_CONST_REF(SnowStyle) style,
                                            KERNEL_CONST_REF(SnowBehind) behind, KERNEL_CONST_REF(SnowJoin) join,
                                            vec3 normal, float height, float bumps, float sink) {
  const vec3 up = vec3(0.0f, 0.0f, 1.0f);
  const SnowProfile profile = front_profile(front, style, behind, join);
  const float bridged = join.bridged;
  // A bridge sinks towards its middle, where the two sides cross at one height.
  const float to_middle = front.half_step + 0.5f * (behind.across - behind.inland);
  // A front that stands in snow rises along the normal, as that snow does.
  const float open = profile.height - profile.base;
  const vec3 leaning = mix(front.lift, front.support, profile.base / max(profile.height, 1e-6f));
  const vec3 lift = leaning * (profile.height * (1.0f - kBridgeDip * bridged)) + up * (to_middle * bridged);
  const vec3 base = front.support * profile.base;
  const vec3 belly = base + up * (kBelly * open);
  const vec3 farthest = front.level_out * profile.overhang + belly;
  const float rough = style.relief * kBumps * bumps * profile.height;
  // On a slope, lifted points move up the slope. They must not pass the points behind them.
  const float upslope = max(-dot(lift, front.outward), 0.0f);
  const float shoulder = min(profile.shoulder, max(0.75f * front.zone - upslope, 0.1f * front.zone));
  const float along = clamp(front.distance / front.zone, 0.0f, 1.0f);
  // At bare rims the front sinks below the receiver, so that nothing protrudes.
  const vec3 sunk = normal * (-sink * eased(profile.height, 0.008f, 0.0f));
  // From the carrier to the rim.
  const vec3 to_rim = front.outward * (front.distance + front.below) - front.down * front.below;

  if (along >= kFrontPart) {
    const float part = (along - kFrontPart) / (1.0f - kFrontPart);
    const float easing = eased(along, kFrontPart, 1.0f);
    const float inwards = mix(shoulder, front.zone, part);
    const float own = mix(profile.height, height, eased(along, 0.8f, 1.0f));
    const vec3 offset = mix(lift, normal * own, easing);
    const vec3 lifted = front.lift * (rough * (1.0f - easing));
    return to_rim - front.outward * inwards + offset + lifted + sunk;
  }
  // Without a far face, the lower part of the front also lies on the supporting face.
  const float lower = (1.0f - front.has_far) * 0.3f;
  const float on_front = along / kFrontPart;
  const bool beyond = front.distance < 0.0f || on_front < lower;
  if (!beyond) {
    const float turn = clamp((on_front - lower) / (1.0f - lower), 0.0f, 1.0f);
    const vec3 inside = front.outward * -shoulder;
    const vec3 at = quarter(inside + belly, farthest, inside + lift, turn, kUpperExponent);
    const float angle = 1.5707963f * turn;
    return to_rim + at + (front.level_out * cos(angle) + front.lift * sin(angle)) * rough + sunk;
  }
  const float eaves = clamp(2.0f * front.eave, 0.0f, 1.0f);
  const float down_way = clamp(-front.distance / (front.far_zone * kTucked), 0.0f, 1.0f);
  const float turn = front.has_far > 0.5f ? down_way : 1.0f - clamp(on_front / max(lower, 1e-6f), 0.0f, 1.0f);
  const vec3 buried = front.support * max(profile.base - kBuried * profile.height, 0.0f);
  const vec3 foot = buried + (front.has_far > 0.5f
                        ? front.down * profile.drop - front.level_out * kTuck
                        : up * (-0.3f * min(profile.drop, 0.1f * open)) - front.level_out * 0.001f);
  const vec3 lowest = buried + front.level_out * (0.9f * profile.overhang) -
                      up * (profile.drop * (1.0f + 0.9f * eaves));
  const float exponent = mix(kLowerExponent, kEaveExponent, eaves);
  const vec3 at = quarter(farthest + foot - lowest, farthest, foot, turn, exponent);
  // Below the hem, points lie inside the receiver where they are: it may be uneven.
  const float own = front.has_far * eased(-front.distance, kTucked * front.far_zone, front.far_zone);
  return mix(to_rim + at + front.level_out * (rough * (1.0f - turn)) + sunk, normal * -sink, own);
}

#ifndef SNOWBOUGH_GLSL
}  // namespace snowbough::shared
#endif
