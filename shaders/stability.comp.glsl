// Adds the step's deposit to the map and lets slide what the slope cannot hold: equation 4.2.2 of
// D. T. Reynolds, Real-Time Rendering and Simulation of Trees and Snow, 2014, solved in closed form,
// so that the result does not depend on the length of a step.
//
// LAST_TILE: the shares of the step's last (mostly only) tile are worked out here, which saves a pass.
// DEPOSIT_MAP: the deposit lies on a map of its own.
// EARLIER_TILES: shares of further tiles wait in DepositShare.
// WALKERS: invocations of a work group, at most kMostWalkers; see snow/walkers.h.
#include "texel_group.h"
#include "texel_place.h"
#ifdef LAST_TILE
#include "texel_share.h"
#endif

layout(local_size_x = WALKERS) in;
#ifdef DEPOSIT_MAP
uniform sampler2DArray deposit_map;
#else
/// Left at 0 for the next step; read as a texture, which llvmpipe reads a whole vector at once from.
layout(std430) writeonly buffer DepositUnits { uint deposit_units[]; };
uniform usamplerBuffer units_before;
uniform float step_depth;
#endif
#ifdef EARLIER_TILES
/// Read, and left at 0 for the next step.
layout(std430) buffer DepositShare { float deposit_share[]; };
#endif
/// An invocation's sums, WALKERS a group of texels: deposited, slid and held volume in m3, number of
/// saturated texels.
layout(std430) writeonly buffer Partials { vec4 partials[]; };
layout(r32f) uniform image2DArray height_map;
/// Per group of texels; kHoldsSnow is set where some lies after the step.
layout(std430) buffer GroupStates { uint group_states[]; };
/// Texels, word by word.
uniform usamplerBuffer texel_words;
/// A TexelStep each.
uniform usamplerBuffer texel_steps;
uniform float max_depth;
/// Seconds; the half-life is positive.
uniform float dt;
uniform float half_life;

/// (1 - 2^(-t / half_life)) / (t ln 2 / half_life): the part of a steady deposit that stays.
float staying_part(float t) {
  const float x = 0.69314718 * t / half_life;
  return x < 1e-2 ? 1.0 - x * (0.5 - x * (1.0 / 6.0 - x / 24.0)) : (1.0 - exp(-x)) / x;
}

/// Parts of the whole step: of what is too much, that slides off; of a steady deposit, that stays.
struct WholeStep {
  float slides;
  float stays;
};

float settle(float height, float deposit, float capacity, WholeStep whole) {
  if (height >= capacity) {
    // What goes is taken from the height, not what stays added to the capacity: beside a capacity of
    // metres past vertical a float would round the height away.
    return max(0.0, height - (height - capacity) * whole.slides + deposit * whole.stays);
  }
  if (height + deposit <= capacity) {
    return height + deposit;
  }
  const float after_crossing = 1.0 - (capacity - height) / deposit;
  return capacity + deposit * after_crossing * staying_part(dt * after_crossing);
}

#ifndef DEPOSIT_MAP
/// The texel's deposit of the whole step, in metres; leaves the sums at 0.
float take_deposit(int index, uvec2 target, float area, out bool saturated) {
  const uint units = texelFetch(units_before, index).x;
  saturated = units == kNowhere;
  float deposit = float(units) * (step_depth / kDepthUnits);
  if (units != 0u) {
    deposit_units[index] = 0u;
  }
#ifdef LAST_TILE
  if (target.y != 0u) {
    deposit += share_of(target, area);
  }
#endif
#ifdef EARLIER_TILES
  const float share = deposit_share[index];
  if (share != 0.0) {
    deposit += share;
    deposit_share[index] = 0.0;
  }
#endif
  return deposit;
}
#endif

void main() {
  // An invocation takes every WALKERS-th texel of the work group's, so that no barrier is needed.
  const int group = listed_group();
  const int begin = group * int(kTexelGroup) + int(gl_LocalInvocationID.x);
  const int resolution = imageSize(height_map).x;
  const float one_over_resolution = 1.0 / float(resolution);
  const WholeStep whole = WholeStep(1.0 - exp2(-dt / half_life), staying_part(dt));
  vec4 sum = vec4(0.0);
  float highest = 0.0;
  for (uint i = 0u; i < kTexelGroup; i += gl_WorkGroupSize.x) {
    const int index = begin + int(i);
    const uint place = texelFetch(texel_words, 4 * index + 1).x;
    if (place == kNowhere) {
      break;
    }
    const uvec4 step = texelFetch(texel_steps, index);
    const float area = uintBitsToFloat(step.z);
    const float capacity = max_depth * uintBitsToFloat(step.w);
    const ivec3 at = decoded_place(place, resolution, one_over_resolution);
#ifdef DEPOSIT_MAP
    const bool saturated = false;
    const float deposit = texelFetch(deposit_map, at, 0).x;
#else
    bool saturated;
    const float deposit = take_deposit(index, step.xy, area, saturated);
#endif
    const float height = imageLoad(height_map, at).x;
    const float settled = settle(height, deposit, capacity, whole);
    if (settled != height) {
      imageStore(height_map, at, vec4(settled));
    }
    highest = max(highest, settled);
    sum += vec4(deposit * area, (height + deposit - settled) * area, settled * area,
                saturated ? 1.0 : 0.0);
  }
  partials[group * WALKERS + int(gl_LocalInvocationID.x)] = sum;
  if (highest > 0.0) {
    atomicOr(group_states[group], kHoldsSnow);
  }
}
