#pragma once

// Adds a texel's deposit of the step to its height, on the side on which it falls, and lets snow beyond the slope's
// capacity slide: equation 4.2.2 of D. T. Reynolds, Real-Time Rendering and Simulation of Trees and Snow, 2014, solved
// in closed form, so that the result does not depend on the length of a step.
#include "kernel.h"
#include "snow_shared.h"

/// Thickness in metres of a gain of kGainUnits: the step's thickness perpendicular to the fall.
KERNEL_UNIFORM(float, full_gain);
KERNEL_UNIFORM(float, max_depth);
/// Least upward part of a normal for the capacity: snow and dust that stick to walls; below -1: none do.
KERNEL_UNIFORM(float, least_up);
/// Seconds; the half-life is positive.
KERNEL_UNIFORM(float, dt);
KERNEL_UNIFORM(float, half_life);

/// (1 - 2^(-t / half_life)) / (t ln 2 / half_life): the fraction of a steady deposit that stays.
float staying_part(float t, float halving) {
  const float x = 0.69314718f * t / halving;
  return x < 1e-2f ? 1.0f - x * (0.5f - x * (1.0f / 6.0f - x / 24.0f)) : (1.0f - exp(-x)) / x;
}

/// Fractions for the whole step: of the excess that slides off; of a steady deposit that stays.
struct WholeStep {
  float slides;
  float stays;
};

WholeStep whole_step() {
  return KERNEL_MAKE2(WholeStep, 1.0f - exp2(-dt / half_life), staying_part(dt, half_life));
}

/// Thickness in metres that a slope holds. `up`: upward part of the normal.
float capacity_of(float up) { return max_depth * max(up, least_up); }

/// True if old plus new snow stays within the slope's capacity. `up`: upward part of the normal.
bool keeps_all(float height, float deposit, float up) {
  const float capacity = height + deposit == 0.0f ? 1.0f : capacity_of(up);
  return height < capacity && height + deposit <= capacity;
}

float stable_height(float height, float deposit, float capacity, WholeStep whole) {
  if (height >= capacity) {
    // Subtracts from the height instead of adding to the capacity: a capacity of minus several metres, past vertical,
    // would round the height away.
    return max(0.0f, height - (height - capacity) * whole.slides + deposit * whole.stays);
  }
  const float after_crossing = 1.0f - (capacity - height) / deposit;
  return capacity + deposit * after_crossing * staying_part(dt * after_crossing, half_life);
}

/// A texel with less than this fraction of a full gain gains nothing: it removes the veil that steep faces would get
/// from pixels at their edge.
KERNEL_CONSTANT float kMinGain = 0.005f;

/// Thickness in metres of a gain; `gain`: relative to a full gain.
float thickness_of(float gain) { return gain < kMinGain ? 0.0f : gain * full_gain; }

/// Whether a texel gains only on its positive side.
bool gains_only_positive(uint gain) { return (gain & (kBackSide | kMixedSides)) == 0u; }

/// Thickness in metres of such a gain.
float positive_deposit(uint gain) { return thickness_of(float(int(gain)) * (1.0f / kGainUnits)); }

/// Thickness in metres of a step's deposit, negative on the back. If snow falls on both sides, all of it lies on the
/// side with more.
float deposit_of(uvec4 step) {
  float gain = float(step.x & ~(kBackSide | kMixedSides)) * (1.0f / kGainUnits);
  bool is_back = (step.x & kBackSide) != 0u;
  if ((step.x & kMixedSides) != 0u) {
    const uint positive = step.x & kMixedMask;
    const uint back = (step.x >> kMixedBits) & kMixedMask;
    gain = float(positive + back) * (1.0f / kMixedUnits);
    is_back = back > positive;
  }
  return is_back ? -thickness_of(gain) : thickness_of(gain);
}

/// Result of a step for a texel.
struct StableTexel {
  /// Negative on the back.
  float height;
  /// Contribution to the step's sums: deposited, slid and held volume in m3, visible area in m2.
  vec4 sums;
};

/// The side on which snow lies, 1 = positive, -1 = back.
float side_of(float height) { return height < 0.0f ? -1.0f : 1.0f; }

/// Upward part of the normal on a side of the texel.
float up_on(float side, uvec4 step) { return uintBitsToFloat(side < 0.0f ? step.w : step.z); }

/// The fraction of the sky that a texel with this deposit saw, times the cosine to the fall.
float visible_part(float deposit) { return full_gain > 0.0f ? deposit / full_gain : 0.0f; }

/// Upward part of the normals of sheets that count as walls.
KERNEL_CONSTANT float kWallSheet = 0.5f;

/// `height` and `deposit` are negative on the back. A texel holds snow on one side: if new snow falls on the other
/// side, the side that faces up keeps or receives its snow, and the other side's slides off. Dust that sticks to both
/// sides of an upright sheet counts on one of them.
StableTexel stabilise_texel(float height, float deposit, uvec4 step, WholeStep whole) {
  const float area = uintBitsToFloat(step.y);
  const float old_snow = abs(height);
  const float new_snow = abs(deposit);
  const bool meet = old_snow > 0.0f && new_snow > 0.0f && side_of(height) != side_of(deposit);
  const float old_up = up_on(side_of(height), step);
  const bool sticks = least_up > -1.0f && abs(old_up) < kWallSheet;
  const bool stays = old_snow > 0.0f && (!meet || old_up > 0.0f || sticks);
  const float side = side_of(stays ? height : deposit);
  const float up = up_on(side, step);
  const float kept_old = stays ? old_snow : 0.0f;
  const float kept_new = stays && meet && !sticks ? 0.0f : new_snow;
  const float stable = keeps_all(kept_old, kept_new, up)
                           ? kept_old + kept_new
                           : stable_height(kept_old, kept_new, capacity_of(up), whole);
  const vec4 sums =
      vec4(new_snow * area, (old_snow + new_snow - stable) * area, stable * area, visible_part(new_snow) * area);
  return KERNEL_MAKE2(StableTexel, stable > 0.0f ? side * stable : 0.0f, sums);
}
